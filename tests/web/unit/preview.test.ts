// Pictures on the start page are true to scale.
import assert from "node:assert/strict";
import test from "node:test";
import { Axis } from "@page/base/axis";
import { cells_under, fitted } from "@page/start/preview";

const uniform = (cells: number, step: number) => new Axis({ type: "uniform", min: 0, step, first: 0, cells }, 0.5);
const graded = new Axis({ type: "graded", planes: [0, 1, 2, 3, 4, 12] }, 0.5);

test("a picture has the proportions of the domain, not of its numbers of cells", () => {
  assert.deepEqual(fitted(uniform(100, 1), uniform(10, 10), 200, 112), [112, 112]);
  assert.deepEqual(fitted(graded, uniform(6, 1), 240, 240), [240, 120]);
  assert.deepEqual(fitted(uniform(10000, 1), uniform(1, 1), 200, 112), [200, 1]);
});

test("each pixel across a graded axis shows the cell that lies there", () => {
  assert.deepEqual(cells_under(graded, 0, 12), [0, 1, 2, 3, 4, 4, 4, 4, 4, 4, 4, 4]);
  assert.deepEqual(cells_under(graded, 1, 6), [0, 1, 2, 2, 2, 2]);
  assert.deepEqual(cells_under(uniform(4, 1), 0, 4), [0, 1, 2, 3]);
});
