// The tiles of a view: each cell in sight lies in exactly one tile, and the level of every tile is right for its pixels.
import assert from "node:assert/strict";
import test from "node:test";
import { Axis, FRAMES } from "@page/base/axis";
import { SMALLEST, cover } from "@page/tiles/cover";
import { type Extent, TILE, cells_of_level, extent_of } from "@page/tiles/place";
import { random_of, whole } from "./random";

const random = random_of(11);

function random_axis(): Axis {
  const cells = whole(random, 1, 40_000);
  if (random() < 0.5) return new Axis({ type: "uniform", min: -3, step: 0.01 + random(), first: 0, cells }, 0.5);
  const planes = [0];
  for (let i = 0; i < cells; ++i) planes.push(planes[i]! + 0.01 + (i / cells) ** 3);
  return new Axis({ type: "graded", planes }, 0.5);
}

const level_count = (axes: readonly Axis[]) => 1 + Math.ceil(Math.log2(Math.max(...axes.map((a) => a.cells))));

function random_sight() {
  const axes = [random_axis(), random_axis(), random_axis()] as const;
  const axis = whole(random, 0, 2) as 0 | 1 | 2;
  const { u, v } = FRAMES[axis];
  const [u0, v0] = [whole(random, 0, axes[u].cells - 1), whole(random, 0, axes[v].cells - 1)];
  const seen: Extent = { u0, v0, u1: whole(random, u0 + 1, axes[u].cells), v1: whole(random, v0 + 1, axes[v].cells) };
  // What is seen gets 10 to 2000 pixels.
  const size = Math.max(axes[u].plane(seen.u1) - axes[u].plane(u0), axes[v].plane(seen.v1) - axes[v].plane(v0));
  return { axis, slice: whole(random, 0, axes[axis].cells - 1), axes, levels: level_count(axes), scale: (10 + 1990 * random()) / size, seen };
}

test("what is in sight is covered once, by tiles of the slice", () => {
  for (let round = 0; round < 300; ++round) {
    const sight = random_sight();
    const places = cover(sight);
    const cells = sight.axes.map((a) => a.cells) as [number, number, number];
    let area = 0;
    for (const place of places) {
      const e = extent_of(place, cells);
      area +=
        Math.max(0, Math.min(e.u1, sight.seen.u1) - Math.max(e.u0, sight.seen.u0)) *
        Math.max(0, Math.min(e.v1, sight.seen.v1) - Math.max(e.v0, sight.seen.v0));
      assert.equal(place.index, sight.slice >> place.level);
      assert.equal(place.axis, sight.axis);
    }
    // Tiles of a tree overlap only when one lies in the other. Then the sum of the areas would be too large.
    assert.equal(area, (sight.seen.u1 - sight.seen.u0) * (sight.seen.v1 - sight.seen.v0));
    assert.ok(places.length <= 200, `${places.length} tiles for a view`);
  }
});

test("a tile's cells are large enough, and those of the next finer level would not be", () => {
  for (let round = 0; round < 300; ++round) {
    const sight = random_sight();
    const { u, v } = FRAMES[sight.axis];
    const pixels = (axis: Axis, from: number, to: number, level: number) =>
      cells_of_level(axis.cells, level) === 1
        ? Number.POSITIVE_INFINITY
        : ((axis.plane(to) - axis.plane(from)) * sight.scale) / Math.ceil((to - from) / 2 ** level);
    const cells = sight.axes.map((a) => a.cells) as [number, number, number];
    for (const place of cover(sight)) {
      const e = extent_of(place, cells);
      if (place.level < sight.levels - 1) {
        assert.ok((e.u1 - e.u0) / 2 ** place.level <= TILE);
        const too_small = (axis: Axis, from: number, to: number) => pixels(axis, from, to, place.level - 1) < SMALLEST;
        assert.ok(place.level === 0 || too_small(sight.axes[u], e.u0, e.u1) || too_small(sight.axes[v], e.v0, e.v1));
      }
    }
  }
});

test("a grid out of sight needs no tile", () => {
  assert.deepEqual(cover({ ...random_sight(), seen: { u0: 0, u1: 0, v0: 0, v1: 0 } }), []);
});
