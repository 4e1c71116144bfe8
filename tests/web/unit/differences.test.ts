// Marks of differences, held against the cells one by one.
import assert from "node:assert/strict";
import test from "node:test";
import { Axis } from "@page/base/axis";
import type { Index3 } from "@page/base/grid";
import { cover } from "@page/tiles/cover";
import { type Place, place_name, tile_size } from "@page/tiles/place";
import { regions_of } from "@page/tiles/regions";
import { SetTable } from "@page/tiles/sets";
import type { Tile } from "@page/tiles/tile";
import { Camera, sample_cells } from "@page/views/drawing/camera";
import { ADDED, ALONE, DIFFERS, PARTLY, REMOVED, SAME, SetComparison, compare_pictures } from "@page/views/drawing/differences";
import { random_of, whole } from "./random";

const random = random_of(3);

test("sets are compared by the names of their materials, whatever their ids", () => {
  const [left, right] = [new SetTable(), new SetTable()];
  const comparison = new SetComparison(
    { names: ["air", "steel", "gold"], background: "air", sets: left },
    { names: ["gold", "air", "wood"], background: "air", sets: right },
  );
  const verdict = (a: number[], b: number[]) => comparison.verdict(left.number_of(a), right.number_of(b));
  assert.equal(verdict([0], [1]), SAME);
  assert.equal(verdict([0], [0]), ADDED);
  assert.equal(verdict([1], [1]), REMOVED);
  assert.equal(verdict([1], [2]), DIFFERS);
  assert.equal(verdict([2], [0, 1]), PARTLY);
  assert.equal(verdict([0, 1], [0]), DIFFERS, "it held something before");
  assert.equal(verdict([0, 2], [0, 1]), SAME);
  assert.equal(verdict([0, 1], [1]), PARTLY);
  assert.equal(verdict([0, 1], [0, 2]), DIFFERS);
  assert.deepEqual([verdict([], [1]), verdict([2], [])], [SAME, SAME], "what can't be read is not marked");
  assert.equal(comparison.verdict(0, right.number_of([1])), ALONE);
  assert.equal(comparison.verdict(left.number_of([1]), 0), ALONE);
  assert.equal(comparison.verdict(0, 0), SAME);
  assert.equal(comparison.verdict(1, right.number_of([1])), SAME, "what is not known is not marked");
});

// A grid of one slice whose cells at every level have random sets of two materials.
class Grid {
  readonly sets = new SetTable();
  readonly cells: Index3;
  readonly levels = 6;
  private readonly tiles = new Map<string, Tile>();
  constructor(
    readonly names: string[],
    readonly axes: readonly [Axis, Axis, Axis],
  ) {
    this.cells = [axes[0].cells, axes[1].cells, 1];
  }
  private tile(place: Place): Tile {
    const name = place_name(place);
    const old = this.tiles.get(name);
    if (old) return old;
    const [width, height] = tile_size(place, this.cells);
    const sets = Uint32Array.from([[0], [1], [0, 1]], (set) => this.sets.number_of(set));
    const labels = Uint8Array.from({ length: width * height }, () => whole(random, 0, place.level === 0 ? 1 : 2));
    const tile = { place, name, width, height, sets, owners: sets, labels, apart: true, bytes: 0 };
    this.tiles.set(name, tile);
    return tile;
  }
  drawn(camera: Camera, each: 1 | 2) {
    const places = cover({ axis: 2, slice: 0, axes: this.axes, levels: this.levels, scale: camera.zoom * camera.ratio, seen: camera.seen() });
    const held = { find: (place: Place) => this.tile(place), is_damaged: () => false };
    const { regions } = regions_of(places, 0, this.levels, this.cells, held, { slice: null, patient: false });
    return { samples: sample_cells(camera, each), regions };
  }
  // The names of the materials at a sample; null outside.
  names_at({ samples, regions }: ReturnType<Grid["drawn"]>, x: number, y: number): Set<string> | null {
    const [u, v] = [samples.columns[x]!, samples.rows[y]!];
    const region = regions.find((r) => u >= r.u0 && u < r.u1 && v >= r.v0 && v < r.v1);
    if (u < 0 || v < 0 || !region?.tile) return null;
    const { place, width, labels, sets } = region.tile;
    const at = ((v >> place.level) - 512 * place.row) * width + (u >> place.level) - 512 * place.column;
    return new Set(this.sets.members(sets[labels![at]!]!)!.map((id) => this.names[id]!));
  }
}

for (const each of [1, 2] as const)
  test(`${each} x ${each} samples per pixel: a pixel has the gravest verdict of its samples, for grids of other cells`, () => {
    const uniform = (min: number, step: number, cells: number) => new Axis({ type: "uniform", min, step, first: 0, cells }, 0.5);
    const graded = new Axis({ type: "graded", planes: Array.from({ length: 301 }, (_, i) => i / 4 + (i * i) / 900) }, 0.5);
    const flat = uniform(0, 1, 1);
    const left = new Grid(["air", "steel"], [uniform(0, 0.5, 700), graded, flat]);
    const right = new Grid(["steel", "wood"], [uniform(-20, 3, 90), uniform(10, 2, 60), flat]);
    const seen = new Set<number>();
    for (let round = 0; round < 20; ++round) {
      const centre: [number, number, number] = [300 * random(), 150 * random(), 0];
      const [width, height] = [whole(random, 20, 90), whole(random, 20, 90)];
      const zoom = 10 ** (2 * random() - 1);
      const camera = ({ axes }: Grid) => new Camera(2, axes, width, height, 1, centre, zoom);
      const [a, b] = [left.drawn(camera(left), each), right.drawn(camera(right), each)];
      const comparison = new SetComparison(
        { names: left.names, background: "air", sets: left.sets },
        { names: right.names, background: "void", sets: right.sets },
      );
      const out = compare_pictures(a, b, comparison);
      for (let y = 0; y < height; ++y)
        for (let x = 0; x < width; ++x) {
          let expected = 0;
          for (let j = 0; j < each; ++j)
            for (let i = 0; i < each; ++i) {
              const [p, q] = [left.names_at(a, x * each + i, y * each + j), right.names_at(b, x * each + i, y * each + j)];
              const common = p && q ? [...p].filter((name) => q.has(name)).length : 0;
              const air = p?.size === 1 && p.has("air");
              const verdict = !p && !q ? SAME : !p || !q ? ALONE : common === 0 ? (air ? ADDED : DIFFERS) : common === p.size && common === q.size ? SAME : PARTLY;
              expected = Math.max(expected, verdict);
            }
          assert.equal(out[y * width + x], expected, `pixel ${x} ${y}`);
          seen.add(expected);
        }
    }
    assert.deepEqual([...seen].sort(), [SAME, ALONE, PARTLY, DIFFERS, ADDED]);
  });
