// The overview's space and camera: axes lie true to scale, and the camera maps both ways. Which picture follows which.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Axis } from "@page/base/axis";
import {
  HOME, along_axis, at_depth_of, between, direction_at, dollied, dollied_to, dot, fitted, in_sight, panned, project, projection_of, straight,
} from "@page/overview/space/camera";
import { edge_depths, labelled_edges } from "@page/overview/space/edges";
import { make_ladder } from "@page/overview/quality";
import { round_length } from "@page/base/lengths";
import { parts_of } from "@page/base/picture_parts";
import { type Vec3, from_space, shortest_side, space_of, to_space } from "@page/overview/space/space";

const graded = new Axis({ type: "graded", planes: [0, 1, 2, 4, 8, 16] }, 0.5);
const uniform = new Axis({ type: "uniform", min: 10, step: 0.5, first: 0, cells: 5 }, 0.5);

test("the longest side of the domain is 2, and its middle is the origin", () => {
  const space = space_of([graded, uniform, uniform]);
  assert.deepEqual(space.half, [1, 2.5 / 16, 2.5 / 16]);
  assert.equal(to_space(space, 0, 16), 1);
  assert.equal(from_space(space, 1, to_space(space, 1, 11.75)), 11.75);
});

test("the shortest side of a cell is that of the thinnest cell of any axis", () => {
  const space = space_of([graded, uniform, uniform]);
  assert.equal(shortest_side(space, [graded, uniform, uniform]), 0.5 / 8);
});

test("projecting a point and casting a ray through its pixel agree, and the domain fits into the panel from every direction", () => {
  const half: Vec3 = [1, 0.6, 0.2];
  for (const [azimuth, elevation] of [[HOME.azimuth, HOME.elevation], [10, -40], [123, 90], [0, -90]] as const)
    for (const [width, height] of [[700, 450], [300, 900]] as const) {
      const view = projection_of(fitted(half, azimuth, elevation, width / height), width, height);
      for (let corner = 0; corner < 8; ++corner) {
        const p: Vec3 = [corner & 1 ? 1 : -1, corner & 2 ? 0.6 : -0.6, corner & 4 ? 0.2 : -0.2];
        const at = project(view, p);
        assert.ok(at.x >= 0 && at.x <= width && at.y >= 0 && at.y <= height && at.far > 0);
        const ray = direction_at(view, at.x, at.y);
        const to = p.map((c, d) => c - view.eye[d]!) as Vec3;
        assert.ok(Math.abs(dot(ray, to) / Math.sqrt(dot(ray, ray) * dot(to, to)) - 1) < 1e-9);
      }
    }
});

test("a place along an axis is found again under its pixel", () => {
  const view = projection_of(fitted([1, 1, 1], HOME.azimuth, HOME.elevation, 1.5), 900, 600);
  for (let d = 0; d < 3; ++d) {
    const p: Vec3 = [0.3, -0.7, 0.5];
    const at = project(view, p);
    const start: Vec3 = [...p];
    start[d] = -1;
    assert.ok(Math.abs(along_axis(view, start, d, at.x, at.y)! - p[d]!) < 1e-9);
  }
});

test("straight views look along the axes, and z is up, or y", () => {
  for (const sky of [1, 2] as const)
    for (let axis = 0; axis < 3; ++axis)
      for (const above of [true, false]) {
        const { azimuth, elevation } = straight(axis, above, sky);
        const { back, up } = projection_of(fitted([1, 1, 1], azimuth, elevation, 1, 0.8, sky), 100, 100);
        assert.ok(Math.abs(back[axis]! - (above ? 1 : -1)) < 1e-9);
        if (axis !== sky) assert.ok(Math.abs(up[sky]! - 1) < 1e-12);
      }
  const { right, up } = projection_of(fitted([1, 1, 1], straight(2, true).azimuth, 90, 1), 100, 100);
  assert.ok(Math.abs(right[0] - 1) < 1e-9 && Math.abs(up[1] - 1) < 1e-9);
});

test("a place is in sight where it is within the picture, and not far before or behind what is looked at", () => {
  const home = fitted([1, 1, 1], HOME.azimuth, HOME.elevation, 1.5);
  assert.ok([[0, 0, 0], [1, 1, 1], [-1, 1, -1]].every((p) => in_sight(home, p as Vec3, 1.5)), "the whole domain");
  const near = { ...home, distance: home.distance / 100 };
  assert.deepEqual([[0, 0, 0], [0.5, 0.5, 0.5], home.target.map((x, d) => x - 0.5 * projection_of(home, 3, 2).back[d]!)].map((p) => in_sight(near, p as Vec3, 1.5)), [true, false, false]);
});

test("flights turn the shorter way round and end where they should", () => {
  const a = { azimuth: 350, elevation: 0, distance: 4, target: [0, 0, 0] as Vec3, sky: 2 as const };
  const b = { ...a, azimuth: 10, distance: 1, target: [3, 0, 0] as Vec3 };
  assert.deepEqual(between(a, b, 0.5), { azimuth: 360, elevation: 0, distance: 2, target: [2, 0, 0], sky: 2 });
  assert.equal((between(a, b, 1).azimuth + 360) % 360, 10);
  assert.deepEqual(between(a, b, 1).target, b.target);
});

test("panning moves the picture with the pointer", () => {
  const orbit = fitted([1, 1, 1], 30, 20, 1.5);
  const before = project(projection_of(orbit, 900, 600), orbit.target);
  const after = project(projection_of(panned(orbit, -0.1, 0.05, 1.5), 900, 600), orbit.target);
  assert.ok(Math.abs(after.x - before.x - 60) < 1e-6 && Math.abs(after.y - before.y - 30) < 1e-6);
});

test("each axis has one numbered edge on the outline, or none when it points at the eye", () => {
  const half: Vec3 = [1, 1, 1];
  const view = projection_of(fitted(half, HOME.azimuth, HOME.elevation, 1.5), 900, 600);
  assert.deepEqual(edge_depths(view, half).sort(), [0, 0, 0, 1, 1, 1, 1, 1, 1, 2, 2, 2]);
  assert.ok(labelled_edges(view, half).every((edge) => edge !== null));
  const { azimuth, elevation } = straight(0, true);
  const seen = labelled_edges(projection_of(fitted(half, azimuth, elevation, 1.5), 900, 600), half);
  assert.equal(seen[0], null);
});

test("moving to a point keeps it where it is seen, and ends before it", () => {
  const from = fitted([1, 1, 1], 30, 20, 1.5);
  const p: Vec3 = [0.4, -0.6, 0.2];
  const before = project(projection_of(from, 900, 600), p);
  for (const factor of [0.5, 0.9, 1.3]) {
    const after = project(projection_of(dollied_to(from, p, factor, 1e-6), 900, 600), p);
    assert.ok(Math.abs(after.x - before.x) < 1e-6 && Math.abs(after.y - before.y) < 1e-6);
    assert.ok(Math.abs(after.far / before.far - factor) < 1e-9);
  }
  let orbit = from;
  for (let i = 0; i < 100; ++i) orbit = dollied_to(orbit, p, 0.7, 0.001);
  assert.ok(Math.abs(project(projection_of(orbit, 900, 600), p).far - 0.001) < 1e-9);
  assert.equal(dollied(orbit, 0.5, 0.001).distance, 0.001);
});

test("turning around what is seen leaves the picture as it is", () => {
  const from = fitted([1, 1, 1], 30, 20, 1.5);
  const to = at_depth_of(from, [0.4, -0.6, 0.2]);
  for (const p of [[0.1, 0.2, 0.3], [-1, 1, 0.5]] as Vec3[]) {
    const [a, b] = [from, to].map((orbit) => project(projection_of(orbit, 900, 600), p));
    assert.ok(Math.abs(a!.x - b!.x) < 1e-6 && Math.abs(a!.y - b!.y) < 1e-6);
  }
});

test("the parts of a sharp picture cover each pixel once, from the middle outwards", () => {
  for (const [width, height] of [[1400, 900], [300, 200], [385, 1], [2800, 1800]] as const) {
    const parts = parts_of(width, height, 384);
    const seen = new Uint8Array(width * height);
    for (const { x0, y0, x1, y1 } of parts) for (let y = y0; y < y1; ++y) for (let x = x0; x < x1; ++x) ++seen[y * width + x]!;
    assert.ok(seen.every((n) => n === 1));
    const off = parts.map(({ x0, y0, x1, y1 }) => Math.hypot(x0 + x1 - width, y0 + y1 - height));
    assert.deepEqual(off, [...off].sort((a, b) => a - b));
  }
});

test("a scale bar has a round length", () => {
  assert.deepEqual([1, 1.9, 2.1, 4.99, 5, 0.031].map(round_length).map((x) => Number(x.toPrecision(6))), [1, 1, 2, 2, 5, 0.02]);
});

test("a slow machine draws fewer pixels and points while something moves, and a fast one draws everything", () => {
  const play = (ms: (pixels: number, points: number) => number) => {
    const ladder = make_ladder(1);
    for (let i = 0; i < 40; ++i) ladder.measured(ladder.quality(), ms(ladder.quality().ratio ** 2, ladder.quality().points));
    return ladder.quality();
  };
  assert.deepEqual(play(() => 2), { ratio: 1, points: 2_000_000 });
  assert.deepEqual(play((pixels, points) => 10 * pixels + points / 5000), { ratio: 1 / 1.5, points: 80_000 });
});

test("a single slow frame changes nothing", () => {
  const ladder = make_ladder(1);
  const before = ladder.quality();
  for (let i = 0; i < 20; ++i) ladder.measured(ladder.quality(), i === 10 ? 90 : 20);
  assert.deepEqual(ladder.quality(), before);
});
