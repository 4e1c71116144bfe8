// The numbers of the overview's rulers are short, lie in the panel, and never overlap.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Axis } from "@page/base/axis";
import { HOME, fitted, projection_of } from "@page/overview/space/camera";
import { labelled_edges } from "@page/overview/space/edges";
import type { Vec3 } from "@page/overview/space/space";
import { type Rect, type Wish, end_text, place_numbers } from "@page/overview/numbers";
import { random_of } from "./random";

const uniform = (min: number, max: number, cells: number) => new Axis({ type: "uniform", min, step: (max - min) / cells, first: 0, cells }, 0.5);

test("numbers have as many digits as a thousandth of the axis, or a cell, warrants", () => {
  const ends = (axis: Axis) => [end_text(axis, axis.min), end_text(axis, axis.max)];
  assert.deepEqual(ends(uniform(-0.43135, 0.43317, 413)), ["−0.431", "0.433"]);
  assert.deepEqual(ends(uniform(-0.0020933, 0.57565, 276)), ["−0.002", "0.576"]);
  assert.deepEqual(ends(uniform(-150, 150, 1200)), ["−150", "150"]);
  assert.deepEqual(ends(uniform(0, 20.25, 40)), ["0", "20.3"]);
  assert.deepEqual(ends(uniform(0, 2.5e-6, 40)), ["0", "2.500 × 10⁻⁶"]);
  assert.deepEqual(ends(uniform(0, 0.3, 1)), ["0", "0.3"]);
});

const overlap = (a: Rect, b: Rect) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

test("from any view, numbers lie in the panel and overlap neither each other nor what is already there", () => {
  const next = random_of(7);
  let [seen, hidden] = [0, 0];
  for (let n = 0; n < 400; ++n) {
    const [width, height] = [300 + 600 * next(), 200 + 500 * next()];
    const half: Vec3 = [1, 0.05 + 0.9 * next(), 0.05 + 0.9 * next()];
    const orbit = n === 0 ? HOME : { azimuth: 360 * next(), elevation: 180 * next() - 90 };
    const view = projection_of(fitted(half, orbit.azimuth, orbit.elevation, width / height), width, height);
    const triad = { left: 0, top: height - 88, right: 88, bottom: height };
    const wishes = labelled_edges(view, half).flatMap((edge): Wish[] => {
      if (!edge) return [];
      const [x, y] = [edge.to.x - edge.from.x, edge.to.y - edge.from.y];
      const length = Math.hypot(x, y);
      return [edge.from, edge.to].map((end, i) => ({
        size: [60, 14],
        end,
        outward: edge.outward,
        beyond: { x: ((2 * i - 1) * x) / length, y: ((2 * i - 1) * y) / length },
      }));
    });
    const rects = place_numbers(wishes, width, height, [triad]).flatMap((p) =>
      p ? [{ left: p.x - 30, top: p.y - 7, right: p.x + 30, bottom: p.y + 7 }] : [],
    );
    rects.forEach((rect, i) => {
      assert.ok(rect.left >= 0 && rect.top >= 0 && rect.right <= width && rect.bottom <= height, "cut off");
      assert.ok(!overlap(rect, triad), "under the triad");
      assert.ok(rects.slice(0, i).every((other) => !overlap(rect, other)), "over another");
    });
    seen += rects.length;
    hidden += wishes.length - rects.length;
  }
  assert.ok(hidden < 0.1 * seen, `${hidden} of ${seen + hidden} have no room`);
});

test("a number that has to give way takes nobody's best place", () => {
  const wish = (x: number, y: number): Wish => ({ size: [40, 14], end: { x, y }, outward: { x: -1, y: 0 }, beyond: { x: 0, y: 1 } });
  // The place of the first number is taken. The place beyond its end is the best one for the second number.
  const [first, second] = [wish(100, 70), wish(130, 95)];
  const [best] = place_numbers([second], 200, 200, []);
  const [, place] = place_numbers([first, second], 200, 200, [{ left: 60, top: 60, right: 70, bottom: 68 }]);
  assert.deepEqual(place, best);
});

test("a number whose end is not in sight is not shown", () => {
  const wish: Wish = { size: [40, 14], end: { x: -1, y: 50 }, outward: { x: 0, y: 1 }, beyond: { x: -1, y: 0 } };
  assert.deepEqual(place_numbers([wish], 200, 100, []), [null]);
});
