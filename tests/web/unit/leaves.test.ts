// Lines between leaves against the leaves themselves, and the sums of counts.
import assert from "node:assert/strict";
import test from "node:test";
import type { Index3 } from "@page/base/grid";
import { slabs, sum_of_counts } from "@page/base/refinement";
import { FINER, type LeafTile, decode_leaf_tile } from "@page/tiles/leaf_tile";
import { packed } from "@page/tiles/sets";
import { color_of_level, paint_leaves } from "@page/views/drawing/leaf_lines";
import { random_of, whole } from "./random";

test("slabs lie side by side, and no leaf lies across two of them", () => {
  const random = random_of(3);
  for (let round = 0; round < 200; ++round) {
    const cells = [0, 1, 2].map(() => whole(random, 1, round % 2 ? 100_000 : 50)) as Index3;
    const coarsest = whole(random, 0, 16);
    const boxes = slabs(cells, coarsest);
    assert.ok(boxes.length <= 65);
    const axis = cells.indexOf(Math.max(...cells));
    let next = 0;
    for (const box of boxes) {
      assert.equal(box[axis], next);
      assert.equal(box[axis]! % 2 ** coarsest, 0);
      next = box[axis + 3]!;
      for (const d of [0, 1, 2].filter((d) => d !== axis)) assert.deepEqual([box[d], box[d + 3]], [0, cells[d]]);
    }
    assert.equal(next, cells[axis]);
  }
});

test("counts are summed by level and material", () => {
  const row = (level: number, material: string, leaves: number) => ({ level, material, leaves });
  const sum = sum_of_counts([
    { total: 7, leaves: [row(1, "air", 3), row(0, "air", 4)] },
    { total: 5, leaves: [row(0, "steel", 2), row(0, "air", 1), row(3, "air", 2)] },
  ]);
  assert.deepEqual(sum, { total: 12, leaves: [row(0, "air", 5), row(0, "steel", 2), row(1, "air", 3), row(3, "air", 2)] });
});

test("a tile of leaves has a byte for each cell", () => {
  const place = { axis: 2, index: 0, level: 0, column: 0, row: 0 } as const;
  assert.equal(decode_leaf_tile(place, [3, 2], new ArrayBuffer(6)).width, 3);
  assert.throws(() => decode_leaf_tile(place, [3, 2], new ArrayBuffer(5)), /expected 6 bytes/);
});

// A quadtree of random leaves over 64 x 64 cells, as a tile of some level has it, and as the number of the leaf at each cell.
function random_tree(random: () => number, level: number): { tile: LeafTile; leaf: Int32Array; level_of: number[] } {
  const size = 64 >> level;
  const levels = new Uint8Array(size * size).fill(FINER);
  const leaf = new Int32Array(64 * 64);
  const level_of: number[] = [];
  const split = (l: number, u: number, v: number): void => {
    if (l > 0 && random() < 0.6) {
      for (const [du, dv] of [[0, 0], [1, 0], [0, 1], [1, 1]] as const) split(l - 1, 2 * u + du, 2 * v + dv);
      return;
    }
    level_of.push(l);
    for (let b = v << l; b < (v + 1) << l; ++b)
      for (let a = u << l; a < (u + 1) << l; ++a) {
        leaf[b * 64 + a] = level_of.length - 1;
        if (l >= level) levels[(b >> level) * size + (a >> level)] = l;
      }
  };
  split(6, 0, 0);
  const place = { axis: 2, index: 0, level, column: 0, row: 0 } as const;
  return { tile: { place, name: "", width: size, levels, bytes: 0 }, leaf, level_of };
}

test("a pixel is drawn on where a leaf begins that is at least two pixels wide or high", () => {
  const random = random_of(11);
  for (let round = 0; round < 60; ++round) {
    const level = whole(random, 0, 3);
    const { tile, leaf, level_of } = random_tree(random, level);
    // Some pixels for each cell of the tile, or some cells for each pixel; a margin outside the grid.
    const step = 2 ** level / whole(random, 1, 4);
    const columns = Int32Array.from([-1, -1, ...Array.from({ length: 64 / step }, (_, i) => Math.floor(i * step)), -1]);
    const rows = Int32Array.from([-1, ...Array.from({ length: 64 / step }, (_, i) => 63 - Math.floor(i * step)), -1, -1]);
    const out = new Uint32Array(columns.length * rows.length);
    paint_leaves(out, { columns, rows, each: 1 }, [{ tile, damaged: false, u0: 0, u1: 64, v0: 0, v1: 64 }]);
    const at = (x: number, y: number): number => ((columns[x] ?? -1) < 0 || (rows[y] ?? -1) < 0 ? -1 : leaf[rows[y]! * 64 + columns[x]!]!);
    for (let y = 0; y < rows.length; ++y)
      for (let x = 0; x < columns.length; ++x) {
        const here = at(x, y);
        const begins = (before: number, after: number) => here >= 0 && level_of[here]! >= level && before !== here && after === here;
        const drawn = begins(at(x - 1, y), at(x + 1, y)) || begins(at(x, y + 1), at(x, y - 1));
        assert.equal(out[y * columns.length + x], drawn ? packed(color_of_level(level_of[here]!)) : 0, `${x}, ${y}`);
      }
  }
});
