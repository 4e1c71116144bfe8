// Places outside the grid are named, with what the grid has; places inside, its sides included, are not.
import assert from "node:assert/strict";
import test from "node:test";
import { Axis } from "@page/base/axis";
import { beyond_reach, outside_box, outside_cell, outside_coordinate, outside_point, outside_slice } from "@page/state/outside";
import { overlap } from "@page/views/overlay_marks";

const axis = (cells: number) => new Axis({ type: "uniform", min: -1, step: 0.5, first: 0, cells }, 0.5);
const axes = [axis(20), axis(4), axis(8)] as const;

test("slices", () => {
  assert.deepEqual([0, 19].map((i) => outside_slice(axes, 0, i)), [null, null]);
  assert.match(outside_slice(axes, 0, 20)!, /^Slice 20 across x is outside the grid, which has slices 0 to 19:/);
  assert.match(outside_slice(axes, 1, -1)!, /^Slice −1 across y /);
});

test("coordinates", () => {
  assert.deepEqual([-1, 0, 9].map((x) => outside_coordinate(axes, 0, x, "mm")), [null, null, null]);
  assert.match(outside_coordinate(axes, 0, 9.5, "mm")!, /^x = 9\.50 mm is outside the grid, which goes from −1\.00 to 9\.00 mm:/);
  assert.match(outside_coordinate(axes, 2, -2, "mm")!, /^z = −2\.00 mm /);
});

test("cells", () => {
  assert.equal(outside_cell(axes, [19, 3, 7]), null);
  assert.match(outside_cell(axes, [19, 4, 7])!, /^Cell 19, 4, 7 is outside the grid, whose last cell is 19, 3, 7:/);
});

test("points that a link looks at", () => {
  assert.equal(outside_point(axes, [-1, 1, 3], "mm"), null);
  assert.equal(outside_point(axes, [0, 1.5, 0], "mm"), "The link looks at y = 1.50 mm, which is outside the grid: the nearest place is shown.");
});

test("boxes", () => {
  assert.equal(outside_box(axes, [0, 0, 0, 20, 4, 8]), null);
  for (const box of [[-1, 0, 0, 20, 4, 8], [0, 0, 0, 20, 5, 8], [3, 0, 0, 3, 4, 8]])
    assert.match(outside_box(axes, box)!, /does not lie in the grid of 20 × 4 × 8 cells: it is left out/);
});

test("labels overlap when they share pixels of a line", () => {
  const label = { left: 10, right: 50, y: 100 };
  assert.ok(overlap(label, { left: 40, right: 80, y: 110 }));
  assert.ok(!overlap(label, { left: 50, right: 80, y: 100 }), "side by side");
  assert.ok(!overlap(label, { left: 10, right: 50, y: 116 }), "one above the other");
});

test("cameras and measured lines may lie outside, but not absurdly far", () => {
  const axes = [axis(10), axis(20), axis(30)] as const;
  assert.equal(beyond_reach(axes, "The camera", [100, -5000, 0]), null);
  assert.equal(beyond_reach(axes, "The camera", [0, 1e300, 0]), "The camera of the link lies far outside the grid: it is left out.");
});
