// What is seen first: what there is, from where it is upright, with the crosshair in a cell of it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { type AxisJson, type GridInfo, type Index3, type Report, ids_in } from "@page/base/grid";
import { upright_axis } from "@page/base/upright";
import { names_a_place, show_what_there_is, what_there_is } from "@page/visits/first_view";
import { type Box, Viewer } from "@page/state/viewer";

const axes: AxisJson[] = [100, 80, 60].map((n) => ({ type: "uniform", min: 0, step: 1, first: 0, cells: n }));

test("what there is are all labels but the background and what is clear from the start", () => {
  const viewer = new Viewer({
    grid: { cells: [100, 80, 60], sample: [0.5, 0.5, 0.5], axes },
    materials: ["#00000000", "#3366cc", "#11223300", "#884400"].map((color, id) => ({ id, name: String(id), color })),
    file: { hash: "0" },
  } as unknown as GridInfo);
  assert.deepEqual(what_there_is(viewer), [1, 3]);
});

const far: Box = [70, 60, 40, 80, 70, 50];
const in_wide_air = (box: Box, found: Index3 | null = [72, 61, 44]) => {
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
    asked.push(/[^/]*(?=&v)/.exec(path)![0]);
    return Response.json({ cell: found, box });
  };
  return { viewer, asked };
};

test("what is small in its domain is framed, and the crosshair is in it, after one request", async () => {
  const { viewer, asked } = in_wide_air(far);
  const arrives = show_what_there_is(viewer, new AbortController().signal);
  assert.ok(viewer.arriving.value);
  await arrives;
  assert.deepEqual(asked, ["nearest?labels=1"]);
  assert.deepEqual(viewer.cell.value, [72, 61, 44]);
  assert.deepEqual(viewer.centre.value, [75, 65, 45]);
  const [x] = viewer.visited.value!;
  assert.ok(x.min < 70 && x.min > 68 && x.max > 80 && x.max < 82 && viewer.zoom.value > 20);
  assert.ok(!viewer.arriving.value);
});

test("where no cell can be read, the crosshair is in the middle of what there is", async () => {
  const { viewer } = in_wide_air(far, null);
  await show_what_there_is(viewer, new AbortController().signal);
  assert.deepEqual(viewer.cell.value, [74, 64, 44]);
  assert.ok(viewer.visited.value);
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

test("an address names its grid, and the one that is compared with it", () => {
  assert.deepEqual(["/api/v1/grids/a%20b/info", "/api/v1/grids/a/diff?with=b", "/api/v1/grids/a/view.bin?size=9,9&against=c", "/healthz"].map(ids_in), [["a b"], ["a", "b"], ["a", "c"], []]);
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
