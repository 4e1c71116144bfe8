// Axes of the page follow the rule of the store: a coordinate belongs to the cell whose planes hold it, the lower plane included.
import assert from "node:assert/strict";
import test from "node:test";
import { Axis } from "@page/base/axis";

const uniform = new Axis({ type: "uniform", min: -0.3, step: 0.1, first: 7, cells: 1000 }, 0.5);
const graded = new Axis({ type: "graded", planes: [-2, -1.5, 0, 0.1, 0.2, 8, 100] }, 0.25);

for (const [name, axis] of [["uniform", uniform], ["graded", graded]] as const) {
  test(`${name}: every plane belongs to the cell above it, and the number just below to the one below`, () => {
    for (let i = 0; i < axis.cells; ++i) {
      const plane = axis.plane(i);
      assert.equal(axis.cell_at(plane), i);
      assert.equal(axis.cell_at(plane - Math.abs(plane) * 2 ** -52 - Number.MIN_VALUE), i - 1);
      assert.equal(axis.cell_at(axis.centre(i)), i);
    }
  });

  test(`${name}: what lies outside is known to lie outside`, () => {
    assert.equal(axis.cell_at(axis.min - 1), -1);
    assert.equal(axis.cell_at(axis.max), axis.cells);
    assert.equal(axis.cell_at(axis.max + 1), axis.cells);
    assert.equal(axis.clamp(-5), 0);
    assert.equal(axis.clamp(axis.cells + 5), axis.cells - 1);
    assert.equal(axis.clamp(2.4), 2);
    assert.equal(axis.width(-3), axis.plane(1) - axis.min);
    assert.equal(axis.width(axis.cells), axis.max - axis.plane(axis.cells - 1));
    assert.deepEqual([axis.min - 1, axis.plane(1), axis.max + 1].map((x) => axis.inside(x)), [axis.min, axis.plane(1), axis.max]);
  });
}

test("the thinnest cell of an axis is known, the first of several", () => {
  assert.deepEqual([graded.thinnest, graded.finest], [2, 0.1]);
  const thinner = new Axis({ type: "graded", planes: [0, 1, 1.25, 2, 2.25, 5] }, 0.5);
  assert.deepEqual([thinner.thinnest, thinner.finest], [1, 0.25]);
  assert.equal(uniform.thinnest, 0);
});

test("planes and centres are rounded as the rule for cells says", () => {
  assert.equal(uniform.plane(3), -0.3 + 10 * 0.1);
  assert.equal(uniform.centre(3), -0.3 + 10.5 * 0.1);
  assert.equal(graded.centre(4), 0.2 + 0.25 * (8 - 0.2));
  assert.ok(graded.graded && !uniform.graded);
});

test("neither cells nor a domain that are thinner than a pixel are passed over", () => {
  assert.equal(graded.cell_among(-0.05, 0.31), 3, "0.13 lies in cell 3");
  assert.equal(graded.cell_among(-1.4, 0.3), 2, "the middle lies in a wide cell, two thin ones within");
  assert.equal(graded.cell_among(-1.4, -0.2), 1);
  assert.equal(graded.cell_among(-500, 100), 3 - 1, "the middle lies outside, all cells within");
  assert.equal(graded.cell_among(-500, 5), -1, "most is outside");
  assert.equal(uniform.cell_among(-1e6, 2e6), 499);
  assert.equal(uniform.cell_among(uniform.plane(10), uniform.plane(13)), 11);
  assert.equal(graded.finest, 0.2 - 0.1);
  assert.ok(Math.abs(uniform.finest - 0.1) < 1e-12);
});
