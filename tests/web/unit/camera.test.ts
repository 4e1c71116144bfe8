// Where cells are on a view.
import assert from "node:assert/strict";
import test from "node:test";
import { Axis, FRAMES } from "@page/base/axis";
import { clamped_zoom, fitting_zoom } from "@page/state/zoom";
import { Camera, sample_cells, zoomed_about } from "@page/views/drawing/camera";
import { random_of, whole } from "./random";

const random = random_of(5);
const long = new Axis({ type: "uniform", min: -1e3, step: 1e-3, first: 5, cells: 1_000_000_000 }, 0.5);
const graded = new Axis({ type: "graded", planes: Array.from({ length: 401 }, (_, i) => i + (i * i) / 50) }, 0.5);
const flat = new Axis({ type: "uniform", min: 0, step: 2, first: 0, cells: 1 }, 0.5);
const axes = [long, graded, flat] as const;

function random_camera(): Camera {
  const centre = axes.map((a) => a.min + random() * (a.max - a.min)) as [number, number, number];
  return new Camera(
    whole(random, 0, 2) as 0 | 1 | 2,
    axes,
    whole(random, 10, 900),
    whole(random, 10, 900),
    1 + random(),
    centre,
    10 ** (6 * random() - 3),
  );
}

test("a place on the view is found again from its coordinates", () => {
  for (let i = 0; i < 200; ++i) {
    const camera = random_camera();
    const [x, y] = [random() * camera.width, random() * camera.height];
    assert.ok(Math.abs(camera.x_of(camera.u_at(x)) - x) < 1e-6 * camera.zoom + 1e-6);
    assert.ok(Math.abs(camera.y_of(camera.v_at(y)) - y) < 1e-6 * camera.zoom + 1e-6);
  }
});

test("every sample in the grid is the cell that holds its middle, or one entirely within it, and its cell counts as seen", () => {
  for (let i = 0; i < 60; ++i) {
    const camera = random_camera();
    for (const each of [1, 2] as const) {
      const { columns, rows } = sample_cells(camera, each);
      const seen = camera.seen();
      const check = (cells: Int32Array, axis: Axis, coordinate: (pixels: number) => number, from: number, to: number) =>
        cells.forEach((cell, s) => {
          const [one, at, other] = [s, s + 0.5, s + 1].map((x) => coordinate(x / (each * camera.ratio))) as [number, number, number];
          const [low, high] = [Math.min(one, other), Math.max(one, other)];
          if (cell < 0) assert.ok((at < axis.min || at >= axis.max) && (low > axis.min || high < axis.max));
          else {
            const [left, right] = [axis.plane(cell), axis.plane(cell + 1)];
            assert.ok(((left <= at && at < right) || (low <= left && right <= high)) && cell >= from && cell < to);
          }
        });
      check(columns, camera.across, (x) => camera.u_at(x), seen.u0, seen.u1);
      check(rows, camera.up, (y) => camera.v_at(y), seen.v0, seen.v1);
    }
  }
});

test("zooming keeps the point under the pointer where it is", () => {
  const box = [graded, graded, graded] as const;
  for (let i = 0; i < 100; ++i) {
    const before = new Camera(2, box, 600, 400, 1, [200, 200, 200], 1);
    const [x, y] = [200 + 200 * random(), 150 + 100 * random()];
    const zoom = 0.5 + 4 * random();
    const [u, v] = zoomed_about(before, x, y, zoom);
    const after = new Camera(2, box, 600, 400, 1, [u, v, 200], zoom);
    assert.ok(Math.abs(after.u_at(x) - before.u_at(x)) < 1e-9 && Math.abs(after.v_at(y) - before.v_at(y)) < 1e-9);
  }
});

test("zooming in ends where the finest cell is as large as a thumb, even if most cells are larger", () => {
  const fine = new Axis({ type: "graded", planes: [0, 0.01, 1, 2, 50] }, 0.5);
  assert.equal(clamped_zoom(1e9, fine.finest, 1), 160 / 0.01);
});

test("a grid that fits lies within all views, and fills the room in one of them", () => {
  const box = [
    new Axis({ type: "uniform", min: -5, step: 1, first: 0, cells: 300 }, 0.5),
    graded,
    new Axis({ type: "uniform", min: 0, step: 1, first: 0, cells: 20 }, 0.5),
  ] as const;
  const views = ([0, 1, 2] as const).map((axis) => ({ axis, width: 500, height: 300 }));
  const zoom = fitting_zoom(box, views);
  let most = 0;
  for (const { axis, width, height } of views) {
    const { u, v } = FRAMES[axis];
    const [w, h] = [(box[u].max - box[u].min) * zoom, (box[v].max - box[v].min) * zoom];
    assert.ok(w <= width && h <= height);
    most = Math.max(most, w / (width - 88), h / (height - 88));
  }
  assert.ok(Math.abs(most - 1) < 1e-12);
  assert.equal(clamped_zoom(zoom, 1, zoom), zoom);
  assert.equal(clamped_zoom(0, 1, zoom), zoom / 10);
});
