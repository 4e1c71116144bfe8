// What is seen first: what there is, from where it is upright, with the crosshair in a cell of it.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { AxisJson, GridInfo, Report } from "@page/base/grid";
import { FRAMES } from "@page/base/axis";
import { upright_axis } from "@page/base/upright";
import { names_a_place, show_what_there_is, what_there_is } from "@page/visits/first_view";
import { type FetchTile, nearest_of } from "@page/visits/nearest_cell";
import { type Box, Viewer } from "@page/state/viewer";
import { tile_size } from "@page/tiles/place";

const axes: AxisJson[] = [100, 80, 60].map((n) => ({ type: "uniform", min: 0, step: 1, first: 0, cells: n }));

test("what there is has the box of all but the background and what is clear from the start", () => {
  const viewer = new Viewer({
    grid: { cells: [100, 80, 60], sample: [0.5, 0.5, 0.5], axes },
    materials: ["#00000000", "#3366cc", "#11223300", "#884400"].map((color, id) => ({ id, name: String(id), color })),
    file: { hash: "0" },
  } as unknown as GridInfo);
  const amount = (box: Box | null) => ({ cells: 1, volume: 1, box });
  const all: Box = [0, 0, 0, 100, 80, 60];
  assert.deepEqual(what_there_is(viewer, [amount(all), amount([5, 6, 7, 10, 11, 12]), amount(all), amount([8, 2, 9, 9, 3, 20])]), { labels: [1, 3], box: [5, 2, 7, 10, 11, 20] });
  assert.equal(what_there_is(viewer, [amount(all), amount(null), amount(all), amount(null)]), null);
});

const far: Box = [70, 60, 40, 80, 70, 50];
const in_wide_air = (box: Box) => {
  const viewer = new Viewer({
    id: "grid", units: "m",
    grid: { cells: [100, 80, 60], sample: [0.5, 0.5, 0.5], axes },
    materials: [{ id: 0, name: "air", color: "#00000000" }, { id: 1, name: "steel", color: "#3366cc" }],
    levels: [{}],
    file: { hash: "0" },
  } as unknown as GridInfo);
  viewer.views = [{ axis: 2, width: 500, height: 400 }];
  const asked: string[] = [];
  (globalThis as { fetch: unknown }).fetch = async (path: string) => {
    asked.push(/stats|tile/.exec(path)![0]);
    if (path.includes("stats")) return Response.json({ materials: [{ box: null }, { box }] });
    return new Response(Uint8Array.from([1, 0, 0, 0, 1, 0, 1, 0, ...new Array(8000).fill(0)])); // steel everywhere
  };
  return { viewer, asked };
};

test("what is small in its domain is framed, and the crosshair is in it, after two requests", async () => {
  const { viewer, asked } = in_wide_air(far);
  const arrives = show_what_there_is(viewer, new AbortController().signal);
  assert.ok(viewer.arriving.value);
  await arrives;
  assert.deepEqual(asked, ["stats", "tile"]);
  assert.deepEqual(viewer.cell.value, [74, 64, 44]);
  assert.deepEqual(viewer.centre.value, [75, 65, 45]);
  const [x] = viewer.visited.value!;
  assert.ok(x.min < 70 && x.min > 68 && x.max > 80 && x.max < 82 && viewer.zoom.value > 20);
  assert.ok(!viewer.arriving.value);
});

test("what fills its domain is seen with all of this, and nothing moves that somebody has moved", async () => {
  const full = in_wide_air([10, 0, 0, 90, 80, 60]);
  await show_what_there_is(full.viewer, new AbortController().signal);
  assert.deepEqual([full.viewer.zoom.value, full.viewer.visited.value], [0, null]);
  const touched = in_wide_air(far);
  const arrives = show_what_there_is(touched.viewer, new AbortController().signal);
  touched.viewer.set_slice(2, 7);
  await arrives;
  assert.deepEqual(touched.viewer.cell.value, [50, 40, 7]);
  const zoomed = in_wide_air(far);
  const later = show_what_there_is(zoomed.viewer, new AbortController().signal);
  zoomed.viewer.zoom.value = 50;
  await later;
  assert.deepEqual([zoomed.viewer.cell.value, zoomed.viewer.zoom.value], [[50, 40, 30], 50]);
});

test("an address that says where to look is obeyed", () => {
  for (const place of ["at=1,2,3", "look=1,2,3", "zoom=2", "orbit=1,2,3,4,5,6", "only=2", "compare=b"]) assert.ok(names_a_place(new URLSearchParams(`g=a&${place}`)), place);
  assert.ok(!names_a_place(new URLSearchParams("g=a&panel=report&layout=3d&bodies=glass")));
});

test("y is up where all inputs are glTF and the scene did not turn them; elsewhere z is, until somebody says otherwise", () => {
  const report = (formats: string[], ...matrices: number[][]) =>
    ({ inputs: formats.map((format) => ({ format })), scene: { bodies: matrices.map((matrix) => ({ matrix })) } }) as unknown as Report;
  const [as_it_is, larger, turned, fallen] = [
    [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0], [5, 0, 0, 9, 0, 5, 0, 9, 0, 0, 5, 9], [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0], [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0],
  ];
  assert.equal(upright_axis(report(["GLB", "glTF"], as_it_is!, larger!)), 1);
  assert.equal(upright_axis({ ...report(["GLB"]), scene: null }), 1, "without a scene nobody has turned it");
  assert.equal(upright_axis(report(["GLB"], turned!)), 2);
  assert.equal(upright_axis(report(["GLB"], fallen!)), 2);
  assert.equal(upright_axis(report(["GLB", "STL"], as_it_is!, as_it_is!)), 2);
  assert.equal(upright_axis(report(["OBJ"], as_it_is!)), 2);
  assert.equal(upright_axis(report([])), 2);
});

// A grid whose cells are told by a function; coarse ones have the labels of all that they hold.
function tiles_of(cells: [number, number, number], is_there: (x: number, y: number, z: number) => boolean) {
  const asked: number[] = [];
  const known = new Map<string, boolean>();
  const holds = (level: number, [x, y, z]: readonly number[]): boolean => {
    if (level === 0) return x! < cells[0] && y! < cells[1] && z! < cells[2] && is_there(x!, y!, z!);
    const name = `${level} ${x} ${y} ${z}`;
    if (!known.has(name)) known.set(name, [0, 1, 2, 3, 4, 5, 6, 7].some((n) => holds(level - 1, [2 * x! + (n & 1), 2 * y! + ((n >> 1) & 1), 2 * z! + (n >> 2)])));
    return known.get(name)!;
  };
  const fetch_tile: FetchTile = async (place) => {
    asked.push(place.level);
    const { u, v, w } = FRAMES[place.axis];
    const [width, height] = tile_size(place, cells);
    const labels = new Uint8Array(width * height);
    const at = [0, 0, 0];
    at[w] = place.index;
    for (let j = 0; j < height; ++j)
      for (let i = 0; i < width; ++i) {
        at[u] = 512 * place.column + i;
        at[v] = 512 * place.row + j;
        labels[j * width + i] = Number(holds(place.level, at));
      }
    const sets = Uint32Array.of(0, 1);
    return { place, name: "", width, height, sets, owners: sets, labels, apart: true, bytes: 0 };
  };
  const nearest = (box: Box, to: [number, number, number]) => nearest_of(fetch_tile, { is_wanted: (set) => set === 1, box, to }, 12);
  return { nearest, asked };
}

test("the nearest cell of a body is its middle, if that is in it, and one request says so", async () => {
  const { nearest, asked } = tiles_of([60, 60, 60], (x, y, z) => Math.hypot(x - 30, y - 30, z - 30) < 9.5);
  assert.deepEqual(await nearest([21, 21, 21, 40, 40, 40], [30, 30, 30]), [30, 30, 30]);
  assert.deepEqual(asked, [0]);
});

test("of a ring it is on the ring, of a flat hall in the stands and not in the floor far below", async () => {
  const ring = tiles_of([60, 60, 20], (x, y, z) => Math.abs(Math.hypot(x - 30, y - 30) - 20) < 2 && z > 5 && z < 12);
  const cell = (await ring.nearest([9, 9, 6, 52, 52, 12], [30, 30, 8]))!;
  assert.ok(Math.abs(Math.hypot(cell[0] - 30, cell[1] - 30) - 20) < 2 && cell[2] === 8, String(cell));
  const hall = tiles_of([100, 100, 22], (x, _, z) => z < 2 || x < 25 || x > 75);
  assert.equal((await hall.nearest([0, 0, 0, 100, 100, 22], [50, 50, 11]))![2], 11);
});

test("pieces beside all slices through the middle are found, too", async () => {
  const { nearest } = tiles_of([40, 40, 40], (x, y, z) => [x, y, z].every((c) => c < 3) || [x, y, z].every((c) => c > 36));
  const cell = (await nearest([0, 0, 0, 40, 40, 40], [19, 19, 19]))!;
  assert.ok(cell.every((c) => c < 3) || cell.every((c) => c > 36), String(cell));
});

test("in a large box it is looked for on a coarse level first, and is a cell of the body all the same", async () => {
  const is_there = (x: number, y: number, z: number) => x >= 3 && x < 1500 && Math.abs(y - 20) === 7 && z === 10;
  const { nearest, asked } = tiles_of([1503, 40, 16], is_there);
  const cell = (await nearest([3, 13, 10, 1500, 28, 11], [751, 20, 10]))!;
  assert.ok(is_there(...cell) && Math.abs(cell[0] - 751) < 4, String(cell));
  assert.equal(Math.max(...asked), 2);
  assert.ok(asked.length < 10, `${asked.length} requests`);
});
