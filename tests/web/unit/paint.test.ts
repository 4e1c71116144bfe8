// Compares the picture with the cells, one by one.
import assert from "node:assert/strict";
import test from "node:test";
import type { Index3 } from "@page/base/grid";
import { Axis } from "@page/base/axis";
import { cover } from "@page/tiles/cover";
import { type Place, coarser, place_name, tile_size } from "@page/tiles/place";
import { regions_of } from "@page/tiles/regions";
import { OUTSIDE, UNKNOWN } from "@page/tiles/sets";
import type { Tile } from "@page/tiles/tile";
import { Camera, sample_cells } from "@page/views/drawing/camera";
import { number_at, paint, paint_outline } from "@page/views/drawing/paint";
import { random_of, whole } from "./random";

const cells: Index3 = [1500, 700, 9];
const levels = 12;
const axes = [
  new Axis({ type: "uniform", min: 3, step: 0.5, first: 0, cells: cells[0] }, 0.5),
  new Axis({ type: "graded", planes: Array.from({ length: cells[1] + 1 }, (_, i) => i + (i * i) / 400) }, 0.5),
  new Axis({ type: "uniform", min: 0, step: 1, first: 0, cells: cells[2] }, 0.5),
] as const;

// A pattern that tells levels, columns and rows apart: the numbers of a tile's sets, from 2.
const pattern = (level: number, u: number, v: number) => 2 + ((level * 5 + (u >> level) * 3 + (v >> level) * 7) % 11);

function tile_of(place: Place): Tile {
  const [width, height] = tile_size(place, cells);
  const labels = new Uint8Array(width * height);
  const sets = Uint32Array.from({ length: 11 }, (_, i) => 2 + i);
  for (let r = 0; r < height; ++r)
    for (let c = 0; c < width; ++c)
      labels[r * width + c] = pattern(place.level, (place.column * 512 + c) * 2 ** place.level, (place.row * 512 + r) * 2 ** place.level) - 2;
  return { place, name: place_name(place), width, height, sets, owners: sets, labels, apart: true, bytes: 0 };
}

// Shades of grey, whose means are easy to compute.
const colors = Uint32Array.from({ length: 16 }, (_, i) => (0xff000000 | (i * 0x101010)) >>> 0);

function painted(camera: Camera, each: 1 | 2, there: (place: Place) => boolean) {
  const tiles = new Map<string, Tile>();
  const places = cover({ axis: 2, slice: 4, axes, levels, scale: camera.zoom * camera.ratio, seen: camera.seen() });
  for (const place of places) {
    const shown = there(place) ? place : coarser(place, 1);
    tiles.set(place_name(shown), tile_of(shown));
  }
  const held = { find: (place: Place) => tiles.get(place_name(place)) ?? null, is_damaged: () => false };
  const { regions } = regions_of(places, 4, levels, cells, held, { slice: null, patient: false });
  const samples = sample_cells(camera, each);
  const [width, height] = [samples.columns.length / each, samples.rows.length / each];
  const out = new Uint32Array(width * height);
  paint(out, samples, regions, colors);
  // The number that should be at each sample.
  const expected = (sx: number, sy: number): number => {
    const [u, v] = [samples.columns[sx]!, samples.rows[sy]!];
    if (u < 0 || v < 0) return OUTSIDE;
    const region = regions.find((r) => u >= r.u0 && u < r.u1 && v >= r.v0 && v < r.v1);
    return region?.tile ? pattern(region.tile.place.level, u, v) : UNKNOWN;
  };
  return { out, samples, regions, width, height, expected };
}

const random = random_of(8);

for (const each of [1, 2] as const)
  for (const whole_tiles of [true, false])
    test(`${each} x ${each} samples per pixel, from ${whole_tiles ? "the right" : "coarser"} tiles: every pixel is the mean of its cells`, () => {
      for (let round = 0; round < 12; ++round) {
        const centre: [number, number, number] = [3 + 750 * random(), 1900 * random(), 0];
        const camera = new Camera(
          2,
          axes,
          whole(random, 20, 160),
          whole(random, 20, 160),
          1 + whole(random, 0, 1) / 2,
          centre,
          10 ** (2.5 * random() - 1),
        );
        const { out, samples, regions, width, height, expected } = painted(
          camera,
          each,
          (place) => whole_tiles || (place.column + place.row) % 2 === 0,
        );
        for (let y = 0; y < height; ++y)
          for (let x = 0; x < width; ++x) {
            const all: number[] = [];
            for (let j = 0; j < each; ++j) for (let i = 0; i < each; ++i) all.push(expected(x * each + i, y * each + j));
            assert.equal(number_at(samples, regions, x * each, y * each), all[0]);
            const grey = all.reduce((sum, n) => sum + n * 0x10, 0) / all.length;
            assert.ok(Math.abs((out[y * width + x]! & 255) - grey) <= (each === 1 ? 0 : 1), `pixel ${x} ${y}`);
            assert.equal(out[y * width + x]! >>> 24, 255);
          }
      }
    });

test("a sheet one cell thick is in the picture, wherever it lies and however far one has zoomed out", () => {
  const long = new Axis({ type: "uniform", min: 0, step: 1, first: 0, cells: 4096 }, 0.5);
  for (let round = 0; round < 200; ++round) {
    const zoom = 0.72 + 0.3 * random();
    const camera = new Camera(2, [long, long, long], 300, 4, 1, [1000 + 50 * random(), 2000, 0], zoom);
    const { columns } = sample_cells(camera, 2);
    const found = new Set(columns);
    for (let cell = columns[0]! + 1; cell < columns[columns.length - 1]!; ++cell) assert.ok(found.has(cell), `cell ${cell} at zoom ${zoom}`);
  }
});

test("outlines are on pixels whose set differs from that on the left or above", () => {
  const camera = new Camera(2, axes, 40, 40, 1, [50, 50, 0], 8);
  const { samples, regions, width, height, expected } = painted(camera, 1, () => true);
  const out = new Uint32Array(width * height);
  paint_outline(out, samples, regions, 7);
  for (let y = 1; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const differs = (x > 0 && expected(x - 1, y) !== expected(x, y)) || expected(x, y - 1) !== expected(x, y);
      assert.equal(out[y * width + x], differs ? 7 : 0);
    }
});
