// Snapping to boundaries, and boxes that are moved by their handles.
import assert from "node:assert/strict";
import test from "node:test";
import { Axis, FRAMES } from "@page/base/axis";
import { measures_csv } from "@page/state/measures";
import type { Box, Measure } from "@page/state/viewer";
import { type Handle, cells_between, cursor_of, dragged, handle_at, handles_of, nearest_plane } from "@page/views/drawing/box_handles";
import { Camera } from "@page/views/drawing/camera";
import { nearer, nearest_boundary } from "@page/views/snap";
import { box_snippet, numbers_comment } from "@page/panels/take_out";
import { random_of, whole } from "./random";

const uniform = (cells: number) => new Axis({ type: "uniform", min: -2, step: 0.5, first: 0, cells }, 0.5);
const graded = new Axis({ type: "graded", planes: [0, 0.1, 0.2, 1, 3, 3.5, 8] }, 0.5);
const axes = [uniform(40), graded, uniform(16)] as const;

test("the nearest boundary within reach is found, and the ends of the runs are none", () => {
  const runs = [[0, 2], [2, 2.5], [2.5, 9]].map(([min, max]) => ({ min: min!, max: max! }));
  assert.equal(nearest_boundary(runs, 2.2, 1), 2);
  assert.equal(nearest_boundary(runs, 2.3, 1), 2.5);
  assert.equal(nearest_boundary(runs, 2.3, 0.1), null);
  assert.equal(nearest_boundary(runs, 0.1, 1), null, "the grid's own side is no boundary between materials");
  assert.equal(nearest_boundary([], 1, 9), null);
});

test("one coordinate snaps, the nearer one: on an aslant boundary both would leave it again", () => {
  const p = [1, 2, 3] as const;
  assert.deepEqual(nearer(p, 0, 1.5, 1, 2.2), [1, 2.2, 3]);
  assert.deepEqual(nearer(p, 0, 1.1, 1, 2.2), [1.1, 2, 3]);
  assert.deepEqual(nearer(p, 0, null, 1, 2.2), [1, 2.2, 3]);
  assert.deepEqual(nearer(p, 0, 1.1, 1, null), [1.1, 2, 3]);
  assert.deepEqual(nearer(p, 0, null, 1, null), [1, 2, 3]);
});

test("cells between two coordinates are those that a line passes through", () => {
  const axis = uniform(40); // from -2, cells of 0.5
  assert.equal(cells_between(axis, -1, 1), 4); // from plane to plane
  assert.equal(cells_between(axis, 1, -1), 4);
  assert.equal(cells_between(axis, -0.75, 0.75), 4); // from centre to centre
  assert.equal(cells_between(axis, 0.1, 0.2), 1);
  assert.equal(cells_between(axis, 0.1, 0.1), 0);
  assert.equal(cells_between(axis, -99, 99), 40);
});

test("the nearest plane is found on uniform and graded axes, also outside", () => {
  for (const axis of axes)
    for (let x = -5; x < 12; x += 0.0371) {
      const i = nearest_plane(axis, x);
      const best = Math.min(...Array.from({ length: axis.cells + 1 }, (_, p) => Math.abs(axis.plane(p) - x)));
      assert.ok(Math.abs(axis.plane(i) - x) <= best + 1e-12, `${x}: plane ${i}`);
    }
});

test("measured lines as a table: names are quoted where they have to be, and those without one have a number", () => {
  const line = (id: number, name: string): Measure => ({ id, name, axis: null, from: [1, 2, 3], to: [4, 6, 3] });
  assert.equal(
    measures_csv([line(4, ""), line(9, 'a "wide", one')], "mm"),
    'name,length_mm,from_x,from_y,from_z,to_x,to_y,to_z,along_x,along_y,along_z\nLine 1,5,1,2,3,4,6,3,3,4,0\n"a ""wide"", one",5,1,2,3,4,6,3,3,4,0\n',
  );
});

test("handles stand at corners, sides and the middle; a small box has those of its corners alone", () => {
  const camera = new Camera(2, axes, 400, 300, 1, [8, 4, 0], 20);
  const places = (box: Box) => handles_of(camera, FRAMES[2], box);
  assert.equal(places([4, 0, 2, 30, 6, 9]).length, 9);
  const small = places([4, 0, 2, 6, 2, 9]);
  assert.deepEqual(small.map(({ u, v }) => `${u},${v}`), ["-1,-1", "1,-1", "-1,1", "1,1"]);
  const corner = places([4, 0, 2, 30, 6, 9]).find(({ u, v }) => u === 1 && v === 1)!;
  assert.deepEqual([corner.x, corner.y], [camera.x_of(axes[0].plane(30)), camera.y_of(8)]);
  assert.deepEqual(handle_at([corner], corner.x + 8, corner.y - 8), corner);
  assert.equal(handle_at([corner], corner.x + 11, corner.y), null);
  assert.equal(cursor_of({ u: 0, v: 1 }), "ns-resize");
});

test("dragging keeps the box in the grid and keeps a cell of it, whatever is dragged where", () => {
  const random = random_of(4);
  for (let n = 0; n < 2000; ++n) {
    const axis = whole(random, 0, 2) as 0 | 1 | 2;
    const low = axes.map((a) => whole(random, 0, a.cells - 1));
    const box = [...low, ...axes.map((a, d) => whole(random, low[d]! + 1, a.cells))] as Box;
    const handle = { u: whole(random, -1, 1), v: whole(random, -1, 1) } as Handle;
    const frame = FRAMES[axis];
    const point = () => [whole(random, -20, 30) + random(), whole(random, -20, 30) + random()] as const;
    const out = dragged(axes, frame, box, handle, point(), point());
    for (const d of [0, 1, 2] as const) {
      assert.ok(out[d] >= 0 && out[d] < out[d + 3]! && out[d + 3]! <= axes[d].cells, `${box} became ${out}`);
      if (handle.u === 0 && handle.v === 0) assert.equal(out[d + 3]! - out[d], box[d + 3]! - box[d], "a box that is moved keeps its cells");
    }
    assert.deepEqual([out[frame.w], out[frame.w + 3]], [box[frame.w], box[frame.w + 3]], "what lies across the slice stays");
  }
});

test("a side goes to the plane under the pointer", () => {
  assert.deepEqual(dragged(axes, FRAMES[2], [4, 1, 0, 30, 5, 16], { u: 1, v: 0 }, [13, 1], [10.1, 99]), [4, 1, 0, 24, 5, 16]);
  assert.deepEqual(dragged(axes, FRAMES[2], [4, 1, 0, 30, 5, 16], { u: 0, v: -1 }, [0, 0.1], [0, 2.5]), [4, 4, 0, 30, 5, 16]);
});

test("the lines for Python name the address once", () => {
  const lines = box_snippet("http://h/api/v1/grids/g/box.npy?region=0,0,0,1,1,1", "# 0 air");
  assert.equal(lines.split("http://h/api").length, 2);
  assert.ok(lines.endsWith("\n# 0 air"));
});

test("a comment says which number is which material, in one line, and where the rest stands", () => {
  const materials = Array.from({ length: 14 }, (_, id) => ({ id, name: id ? `m\n${id}` : "air", color: "#000000", rank: id }));
  assert.equal(numbers_comment(materials.slice(0, 2), "http://h/g"), "# 0 air, 1 m 1");
  assert.match(numbers_comment(materials, "http://h/g"), /^# 0 air, .*, 11 m 11 and 2 more: http:\/\/h\/g$/);
});
