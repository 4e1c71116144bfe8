// The plane of the oblique view: directions, angles, and what it has in common with the domain.
import assert from "node:assert/strict";
import test from "node:test";
import { Axis } from "@page/base/axis";
import { SLICE_NORMALS, type Vec3, angles_of, dot, normal_of, normal_through, onto, outline_of, plane_frame, plus, steepest, turned } from "@page/oblique/frame";
import { random_of } from "./random";

const random = random_of(9);
const random_normal = (): Vec3 => normal_of({ azimuth: 360 * random() - 180, elevation: 180 * random() - 90 });
const near = (a: readonly number[], b: readonly number[], by = 1e-12) => a.every((x, d) => Math.abs(x - b[d]!) < by);

test("slices across an axis are planes: u points right and v up", () => {
  const frames = SLICE_NORMALS.map((normal) => plane_frame(normal, [0, 0, 0]));
  assert.ok(near(frames[0]!.right, [0, 1, 0]) && near(frames[0]!.up, [0, 0, 1]));
  assert.ok(near(frames[1]!.right, [1, 0, 0]) && near(frames[1]!.up, [0, 0, 1]));
  assert.ok(near(frames[2]!.right, [1, 0, 0]) && near(frames[2]!.up, [0, 1, 0]));
});

test("directions are at right angles, with length 1, and the picture is seen from where the normal points", () => {
  for (let i = 0; i < 100; ++i) {
    const { normal, right, up } = plane_frame(random_normal(), [1, 2, 3]);
    for (const [a, b] of [[normal, right], [normal, up], [right, up]] as const) assert.ok(Math.abs(dot(a, b)) < 1e-12);
    for (const a of [normal, right, up]) assert.ok(Math.abs(dot(a, a) - 1) < 1e-12);
    assert.ok(up[2] >= 0);
  }
});

test("angles give their normal back, also straight up, and right angles are exact", () => {
  for (let i = 0; i < 100; ++i) {
    const normal = random_normal();
    assert.ok(near(normal_of(angles_of(normal)), normal));
  }
  assert.deepEqual(normal_of({ azimuth: 90, elevation: 0 }), [0, 1, 0]);
  assert.deepEqual(normal_of({ azimuth: 12, elevation: 90 }), [0, 0, 1]);
  assert.deepEqual(turned({ azimuth: 170, elevation: 80 }, 30, 30), { azimuth: -160, elevation: 90 });
});

test("a plane goes through three points, but not through three on a line", () => {
  for (let i = 0; i < 50; ++i) {
    const points = [0, 1, 2].map(() => [random(), random(), random()] as const) as [Vec3, Vec3, Vec3];
    const frame = plane_frame(normal_through(points)!, points[0]);
    for (const p of points) assert.ok(near(onto(frame, p), p, 1e-9));
  }
  assert.equal(normal_through([[0, 0, 0], [1, 1, 1], [3, 3, 3]]), null);
});

test("the outline is where the plane meets the edges of the domain, in order around it", () => {
  const axes = [10, 20, 5].map((cells) => new Axis({ type: "uniform", min: -1, step: 0.5, first: 0, cells }, 0.5)) as [Axis, Axis, Axis];
  for (let i = 0; i < 100; ++i) {
    const through: Vec3 = [-1 + 5 * random(), -1 + 10 * random(), -1 + 2.5 * random()];
    const frame = plane_frame(random_normal(), through);
    const outline = outline_of(frame, axes);
    assert.ok(outline.length >= 3 && outline.length <= 6);
    outline.forEach((p, n) => {
      assert.ok(near(onto(frame, p), p, 1e-9));
      assert.ok(p.filter((x, d) => Math.abs(x - axes[d]!.min) < 1e-9 || Math.abs(x - axes[d]!.max) < 1e-9).length >= 2);
      // The point inside lies to the left of each side.
      const next = plus(outline[(n + 1) % outline.length]!, p, -1);
      const off = plus(through, p, -1);
      assert.ok(dot(frame.right, next) * dot(frame.up, off) - dot(frame.up, next) * dot(frame.right, off) > -1e-9);
    });
  }
});

test("a step of the wheel goes along the axis that moves the plane most", () => {
  assert.equal(steepest([0.1, -0.9, 0.3]), 1);
});
