// What keys do to the crosshair and to a measured line.
import assert from "node:assert/strict";
import test from "node:test";
import type { GridInfo } from "@page/base/grid";
import { Viewer } from "@page/state/viewer";
import { choose_tool, escape, mark_measure, remove_chosen, step_crosshair } from "@page/views/actions";

const cells = [100, 20, 7];
const viewer = () =>
  new Viewer({
    id: "grid",
    units: "mm",
    grid: { cells, sample: [0.5, 0.5, 0.5], axes: cells.map((n) => ({ type: "uniform", min: 0, step: 1, first: 0, cells: n })) },
    materials: [],
    file: { hash: "0" },
  } as unknown as GridInfo);

test("steps move the crosshair in the plane of the slice, by cells of the level shown, and end at the grid's sides", () => {
  const v = viewer();
  v.set_cell([50, 10, 3]);
  step_crosshair(v, 2, 1, -1);
  assert.deepEqual(v.cell.value, [51, 9, 3]);
  step_crosshair(v, 0, 1, 1);
  assert.deepEqual(v.cell.value, [51, 10, 4]);
  v.level[1].value = 3;
  step_crosshair(v, 1, -1, 1);
  assert.deepEqual(v.cell.value, [43, 10, 6]);
});

test("the views follow a crosshair that would leave them", () => {
  const v = viewer();
  v.views = [{ axis: 2, width: 100, height: 100 }];
  v.zoom.value = 10;
  v.go_to_cell([50, 10, 3]);
  for (let i = 0; i < 5; ++i) step_crosshair(v, 2, 1, 0);
  assert.equal(v.centre.value[0], 50.5);
  step_crosshair(v, 2, 1, 0);
  assert.equal(v.centre.value[0], 56.5);
});

test("a line is measured by keys: it begins and ends where the crosshair is", () => {
  const v = viewer();
  v.set_cell([50, 10, 3]);
  mark_measure(v, 2);
  assert.equal(v.measure.value, null, "without the tool there is no line");
  choose_tool(v, "measure");
  mark_measure(v, 2);
  step_crosshair(v, 2, 3, 4);
  mark_measure(v, 2);
  const line = { id: 1, name: "", axis: 2, from: [50.5, 10.5, 3.5], to: [53.5, 14.5, 3.5] };
  assert.deepEqual(v.measure.value, line);
  assert.equal(v.tool.value, "look");
  step_crosshair(v, 2, 1, 0);
  assert.deepEqual(v.measure.value, line, "a finished line stays");
});

test("Escape gives up a line that has no end yet, and lets go of one that has, which Delete removes", () => {
  const v = viewer();
  choose_tool(v, "measure");
  mark_measure(v, 2);
  mark_measure(v, 2);
  choose_tool(v, "measure");
  mark_measure(v, 2);
  assert.equal(v.measures.value.length, 2);
  escape(v);
  assert.deepEqual([v.measures.value.length, v.tool.value], [1, "look"]);
  v.chosen.value = 1;
  escape(v);
  assert.deepEqual([v.measures.value.length, v.chosen.value], [1, null]);
  remove_chosen(v);
  assert.equal(v.measures.value.length, 1, "none is chosen");
  v.chosen.value = 1;
  remove_chosen(v);
  assert.deepEqual([v.measures.value, v.chosen.value], [[], null]);
});

test("a line that was given up is begun anew", () => {
  const v = viewer();
  v.set_cell([50, 10, 3]);
  choose_tool(v, "measure");
  mark_measure(v, 2);
  choose_tool(v, "measure");
  choose_tool(v, "measure");
  v.set_cell([10, 10, 3]);
  mark_measure(v, 2);
  assert.equal(v.tool.value, "measure");
  assert.deepEqual(v.measure.value?.from, [10.5, 10.5, 3.5]);
});
