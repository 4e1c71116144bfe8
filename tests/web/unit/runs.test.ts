// The column profile: which run holds a cell, where the next change is, ticks, CSV.
import assert from "node:assert/strict";
import test from "node:test";
import type { ColumnRun } from "@page/base/grid";
import { Axis } from "@page/base/axis";
import { ticks } from "@page/base/ticks";
import { next_change, run_at, run_text, runs_csv } from "@page/dock/runs";

const axis = new Axis({ type: "uniform", min: -1, step: 0.5, first: 0, cells: 20 }, 0.5);
const run = (from: number, to: number, material: number, name: string): ColumnRun => ({
  from,
  to,
  min: axis.plane(from),
  max: axis.plane(to),
  material,
  name,
});
const runs = [run(0, 4, 0, "air"), run(4, 5, 1, "steel"), run(5, 17, 0, "air"), run(17, 20, 2, 'say "tin", thin')];

test("every cell is in the run that holds it", () => {
  for (let i = 0; i < 20; ++i) {
    const found = runs[run_at(runs, i)]!;
    assert.ok(found.from <= i && i < found.to, `cell ${i}`);
  }
});

test("the next change is the first cell of another material upwards, or the last one downwards", () => {
  assert.deepEqual([0, 3, 4, 5, 16].map((i) => next_change(runs, i, true)), [4, 4, 5, 17, 17]);
  assert.deepEqual([19, 17, 16, 4, 3].map((i) => next_change(runs, i, false)), [16, 16, 4, 3, 0]);
  assert.equal(next_change(runs, 18, true), 19); // no change follows, so it is the end
});

test("a run in words: its cells, where it lies, and how long it is", () => {
  assert.equal(run_text(runs[1]!, axis, "mm"), "steel: 0.50000 mm long, cell 4, 1.00 to 1.50 mm");
  assert.equal(run_text(runs[2]!, axis, "mm"), "air: 6.0000 mm long, cells 5 to 16 (12), 1.50 to 7.50 mm");
});

test("a table for other programs has plain numbers, and names in quotes where necessary", () => {
  const csv = runs_csv([{ axis: "x", at: [0, 0], runs }], "mm").split("\n");
  assert.equal(csv[0], "axis,from,to,min_mm,max_mm,length_mm,id,material");
  assert.equal(csv[2], "x,4,5,1,1.5,0.5,1,steel");
  assert.equal(csv[4], 'x,17,20,7.5,9,1.5,2,"say ""tin"", thin"');
  assert.equal(csv.length, 6);
});

test("ticks are round, within the axis, and no more than asked for", () => {
  assert.deepEqual(ticks(-150, 150, 6), [-150, -100, -50, 0, 50, 100, 150]);
  assert.deepEqual(ticks(0.03, 0.98, 5), [0.2, 0.4, 0.6000000000000001, 0.8]);
  for (const [low, high] of [[-3, 1e6], [1e-9, 3e-9], [5, 5.0001]] as const)
    for (const most of [1, 2, 3, 7, 20]) {
      const list = ticks(low, high, most);
      assert.ok(list.length <= most + 1, `${list.length} ticks of ${most}`);
      assert.ok(list.every((t) => t >= low - 1e-6 * (high - low) && t <= high + 1e-6 * (high - low)));
    }
  assert.deepEqual(ticks(1, 1, 5), []);
});
