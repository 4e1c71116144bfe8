// Two grids with one crosshair and one camera: places are the same in coordinates, whatever the cells.
import assert from "node:assert/strict";
import test from "node:test";
import { axes_of } from "@page/base/axis";
import { AXES, type AxisIndex, type AxisJson, type GridInfo, type Index3 } from "@page/base/grid";
import { change_comparison, common_bounds, in_units, link, looks_by_name, middle_of, new_comparison, slices_meet, toggle_comparison, totals_of, unequal_cells } from "@page/state/comparison";
import { Viewer } from "@page/state/viewer";
import type { Range } from "@page/state/zoom";
import { random_of, whole } from "./random";

const random = random_of(15);

function info_of(axes: AxisJson[], more: Partial<GridInfo> = {}): GridInfo {
  const cells = axes.map((a) => (a.type === "uniform" ? a.cells : a.planes.length - 1)) as Index3;
  const grid = { min: [0, 0, 0], max: [1, 1, 1], cells, sample: [0.5, 0, 0.25], axes, cells_text: "" };
  return { id: "g", units: "mm", grid, materials: [], file: { bytes: 1, version: "1.0", hash: "0" }, ...more } as unknown as GridInfo;
}
const uniform = (min: number, step: number, cells: number): AxisJson => ({ type: "uniform", min, step, first: 0, cells });
function random_axis(): AxisJson {
  const cells = whole(random, 1, 60);
  if (random() < 0.5) return uniform(-3 + random(), 0.05 + random() / 4, cells);
  let at = -3 + random();
  return { type: "graded", planes: Array.from({ length: cells + 1 }, () => (at += 0.01 + random() / 3)) };
}
const random_info = () => info_of([random_axis(), random_axis(), random_axis()]);

// Two viewers, of which the page's is the left one.
function linked(a: GridInfo, b: GridInfo, axis: AxisIndex = 2) {
  const [left, right] = [new Viewer(a), new Viewer(b)];
  left.compare.value = new_comparison(left, "b", axis);
  link(left, right, left.compare);
  return { left, right, comparison: left.compare };
}
const random_cell = ({ cells }: Viewer): Index3 => [whole(random, 0, cells[0] - 1), whole(random, 0, cells[1] - 1), whole(random, 0, cells[2] - 1)];

test("the crosshair on one side is in the cell that holds the middle of the other one's, or the nearest to it", () => {
  for (let round = 0; round < 300; ++round) {
    const { left, right } = linked(random_info(), random_info(), whole(random, 0, 2) as AxisIndex);
    const [from, to] = random() < 0.5 ? [left, right] : [right, left];
    const cell = random_cell(from);
    from.set_cell(cell);
    assert.deepEqual(from.cell.value, cell, "the cell that follows is not followed back");
    for (const d of AXES) {
      const x = middle_of(from.axes[d], cell[d]);
      const axis = to.axes[d];
      const i = to.cell.value[d];
      assert.ok((axis.plane(i) <= x || i === 0) && (x < axis.plane(i + 1) || i === axis.cells - 1));
    }
  }
});

test("equal grids have the crosshair in the same cell, wherever sample points lie", () => {
  for (let round = 0; round < 100; ++round) {
    const info = random_info();
    const { left, right } = linked(info, info);
    left.set_cell(random_cell(left));
    assert.deepEqual(right.cell.value, left.cell.value);
    right.set_cell(random_cell(right));
    assert.deepEqual(left.cell.value, right.cell.value);
  }
});

test("slices that move together stay apart by the same length, and all slices are reached on both sides", () => {
  const { left, right, comparison } = linked(info_of([uniform(0, 1, 9), uniform(0, 1, 9), uniform(0, 1, 40)]), info_of([uniform(0, 1, 9), uniform(0, 1, 9), uniform(0, 4, 10)]));
  comparison.value = { ...comparison.value!, apart: 8 };
  for (let k = 0; k < 40; ++k) {
    left.set_slice(2, k);
    assert.equal(left.slice[2].value, k);
    assert.equal(right.slice[2].value, Math.min(Math.floor((k + 8) / 4), 9));
  }
  for (let k = 2; k < 10; ++k) {
    right.set_slice(2, k);
    assert.deepEqual([left.slice[2].value, right.slice[2].value], [4 * k + 2 - 8, k]);
  }
});

test("slices that move on their own change the length by which they are apart, and the crosshair follows within them", () => {
  const info = info_of([uniform(0, 1, 9), uniform(0, 1, 9), uniform(0, 0.5, 40)]);
  const { left, right, comparison } = linked(info, info);
  comparison.value = { ...comparison.value!, together: false };
  right.set_slice(2, 30);
  assert.equal(left.slice[2].value, 20);
  assert.equal(comparison.value!.apart, 5);
  left.set_cell([1, 2, 10]);
  assert.deepEqual(right.cell.value, [1, 2, 30]);
  assert.equal(comparison.value!.apart, 10);
  comparison.value = { ...comparison.value!, apart: -2 };
  assert.equal(right.slice[2].value, 6);
  comparison.value = { ...comparison.value!, together: true };
  left.set_slice(2, 20);
  assert.equal(right.slice[2].value, 16);
});

test("slices meet unless one grid ends before the other", () => {
  const axes = (cells: number) => [uniform(0, 1, 9), uniform(0, 1, 9), uniform(0, 1, cells)];
  const { left, right, comparison } = linked(info_of(axes(40)), info_of([...axes(9).slice(0, 2), uniform(5, 4, 5)]));
  for (let k = 0; k < 40; ++k) {
    left.set_slice(2, k);
    assert.equal(slices_meet(left, right, comparison.value!), k >= 5 && k < 25, `slice ${k}`);
  }
  comparison.value = { ...comparison.value!, together: false };
  right.set_slice(2, 0);
  assert.ok(slices_meet(left, right, comparison.value!), "slices that move on their own are where they are");
});

test("two slices of one grid begin apart, inside the grid", () => {
  for (const k of [0, 20, 39]) {
    const viewer = new Viewer(info_of([uniform(0, 1, 9), uniform(0, 1, 9), uniform(0, 0.5, 40)]));
    viewer.set_slice(2, k);
    const { together, apart } = new_comparison(viewer, "g", 2);
    assert.equal(together, false);
    const at = middle_of(viewer.axes[2], k) + apart;
    assert.ok(apart !== 0 && at > 0 && at < 20);
  }
});

test("a grid in another unit lies at the same place", () => {
  const info = info_of([uniform(1, 0.5, 4), { type: "graded", planes: [0, 1, 4] }, uniform(0, 2, 3)], { units: "m" });
  const axes = axes_of(in_units(info, "mm"));
  assert.deepEqual([axes[0].min, axes[0].max, axes[0].plane(1)], [1000, 3000, 1500]);
  assert.deepEqual([axes[1].plane(0), axes[1].plane(1), axes[1].plane(2)], [0, 1000, 4000]);
  assert.equal(in_units(info, "m"), info);
  assert.equal(in_units({ ...info, units: "cells" }, "mm").units, "cells");
});

test("both grids lie within what can be looked at, and nothing more", () => {
  const [a, b] = [random_info(), random_info()].map(axes_of) as [ReturnType<typeof axes_of>, ReturnType<typeof axes_of>];
  common_bounds(a, b).forEach(({ min, max }, d) => {
    assert.equal(min, Math.min(a[d]!.min, b[d]!.min));
    assert.equal(max, Math.max(a[d]!.max, b[d]!.max));
  });
});

test("materials of the same name look the same on both sides", () => {
  const look = (n: number) => ({ color: [n, n, n] as const, visible: true, opacity: 1 });
  const material = (name: string) => ({ id: 0, name, color: "#000000", rank: 0 });
  const looks = looks_by_name([material("air"), material("steel")], [look(1), look(2)], ["gold", "steel", "air"].map(material), [look(7), look(8), look(9)]);
  assert.deepEqual(looks, [look(7), look(2), look(1)]);
});

test("the words for unequal cells name the unit or the numbers of cells", () => {
  const [a, b] = [info_of([uniform(0, 1, 9), uniform(0, 1, 9), uniform(0, 1, 4)]), info_of([uniform(0, 1, 9), uniform(0, 1, 9), uniform(0, 1, 5)])];
  assert.equal(unequal_cells(a, a), null);
  assert.equal(unequal_cells(a, b), "one has 9 × 9 × 4 cells, the other 9 × 9 × 5");
  assert.equal(unequal_cells(a, { ...a, units: "um" }), "one is in mm, the other in µm");
});

test("a comparison begins with a grid of as many cells, or else another one, or another slice", () => {
  const viewer = new Viewer(info_of([uniform(0, 1, 9), uniform(0, 1, 9), uniform(0, 1, 4)]));
  const summary = (id: string, n: number) => ({ id, cells: [9, 9, n] }) as never;
  const chosen = (...ids: never[]) => {
    toggle_comparison(viewer, ids);
    const other = viewer.compare.value!.other;
    toggle_comparison(viewer, ids);
    assert.equal(viewer.compare.value, null);
    return other;
  };
  assert.equal(chosen(summary("a", 5), summary("g", 4), summary("h", 4)), "h");
  assert.equal(chosen(summary("a", 5), summary("g", 4)), "a");
  assert.equal(chosen(summary("g", 4)), "g");
  assert.equal(chosen(), "g");
});

test("a comparison ends with the slices as they were, unless somebody has moved them, and begins again with the same grid", () => {
  const viewer = new Viewer(info_of([uniform(0, 1, 9), uniform(0, 1, 9), uniform(0, 1, 4)]));
  const toggle = () => toggle_comparison(viewer, ["x", "y"].map((id) => ({ id, cells: [9, 9, 4] }) as never));
  const seen = () => [viewer.centre.value, viewer.zoom.value, viewer.bodies.value];
  const there = [{ min: 1, max: 2 }, { min: 1, max: 3 }, { min: 0, max: 1 }] as [Range, Range, Range];
  [viewer.centre.value, viewer.zoom.value] = [[4, 3, 2], 5];
  const before = seen();
  toggle();
  change_comparison(viewer, { ...viewer.compare.value!, other: "y", space: true, mode: "differs" });
  assert.equal(viewer.bodies.value, "whole");
  change_comparison(viewer, { ...viewer.compare.value!, mode: "wipe" });
  assert.equal(viewer.bodies.value, "cut", "the place that was gone to is seen");
  viewer.frame(there);
  assert.equal(viewer.shows_all(), false);
  toggle();
  assert.deepEqual(seen(), before);
  toggle();
  assert.deepEqual([viewer.compare.value!.other, viewer.compare.value!.mode], ["y", "wipe"]);
  viewer.frame(there);
  [viewer.centre.value, viewer.zoom.value] = [[1.5, 2, 0.5], 9];
  toggle();
  assert.deepEqual(seen(), [[1.5, 2, 0.5], 9, "cut"]);
});

test("what differs is added, removed or of another material, by the background of each grid, and counted exactly", () => {
  const change = (from: string, to: string, cells: string) => ({ from, to, cells: Number(cells), cells_text: cells, box: [0, 0, 0, 1, 1, 1] as [number, number, number, number, number, number] });
  const changes = [change("air", "steel", "9007199254740993"), change("air", "gold", "2"), change("steel", "void", "7"), change("void", "air", "5")];
  assert.deepEqual(totals_of(changes, "air", "void"), { added: 9007199254740995n, removed: 7n, differs: 5n });
});
