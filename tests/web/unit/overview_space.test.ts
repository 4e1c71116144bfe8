// The overview's space: levels of graded and uneven axes lie true to scale, pictures of slices too, and the camera maps both ways.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Axis } from "@page/base/axis";
import { initial_looks } from "@page/base/materials";
import { HOME, along_axis, between, direction_at, dot, fitted, panned, project, projection_of, straight } from "@page/overview/camera";
import { edge_depths, labelled_edges } from "@page/overview/edges";
import { type Vec3, cells_of_level, coordinate_at, from_space, level_planes, level_within, space_of, to_space } from "@page/overview/level_axis";
import { make_ladder } from "@page/overview/quality";
import { decode_slice, slice_picture, slice_place } from "@page/overview/slice_picture";
import { clear_order } from "@page/overview/body_meshes";
import { CUBE, cubes_of, empty_volume, place_cube } from "@page/overview/volume";

const graded = new Axis({ type: "graded", planes: [0, 1, 2, 4, 8, 16] }, 0.5);
const uniform = new Axis({ type: "uniform", min: 10, step: 0.5, first: 0, cells: 5 }, 0.5);

test("a level keeps every 2^level-th plane, and its last cell ends with the axis", () => {
  assert.deepEqual([...level_planes(graded, 1)], [0, 2, 8, 16]);
  assert.deepEqual([...level_planes(uniform, 1)], [10, 11, 12, 12.5]);
  assert.deepEqual([...level_planes(uniform, 0)], [10, 10.5, 11, 11.5, 12, 12.5]);
});

test("coordinates are linear within each cell", () => {
  const planes = level_planes(graded, 1);
  assert.equal(coordinate_at(planes, 1.5), 5);
  assert.equal(coordinate_at(planes, 0), 0);
  assert.equal(coordinate_at(planes, 3), 16);
  assert.equal(coordinate_at(planes, 2.25), 10);
});

test("the longest side of the domain is 2, and its middle is the origin", () => {
  const space = space_of([graded, uniform, uniform]);
  assert.deepEqual(space.half, [1, 2.5 / 16, 2.5 / 16]);
  assert.equal(to_space(space, 0, 16), 1);
  assert.equal(from_space(space, 1, to_space(space, 1, 11.75)), 11.75);
});

test("levels are chosen by their longest side", () => {
  assert.equal(level_within([10000, 10000, 10000], 160, 15), 6);
  assert.equal(level_within([100, 20, 3], 160, 8), 0);
  assert.equal(level_within([10000, 1, 1], 160, 3), 2);
  assert.deepEqual(cells_of_level([10000, 5, 1], 6), [157, 1, 1]);
});

test("cubes are put together without their padding", () => {
  const volume = empty_volume([70, 2, 1], false);
  assert.deepEqual(cubes_of(volume.size), [[0, 0, 0], [1, 0, 0]]);
  for (const place of cubes_of(volume.size))
    place_cube(
      volume,
      place,
      Uint8Array.from({ length: CUBE ** 3 }, (_, i) => (i % CUBE) + 100 * place[0]!),
    );
  assert.deepEqual([volume.labels[63], volume.labels[64], volume.labels[69], volume.labels[70 + 65]], [63, 100, 105, 101]);
});

test("the picture of a slice shows graded cells true to scale and ends where the grid ends", () => {
  const axes = [graded, uniform, new Axis({ type: "uniform", min: 0, step: 1, first: 0, cells: 1 }, 0.5)] as const;
  const place = slice_place(axes, 2, 0, 4);
  assert.deepEqual(place, { axis: 2, level: 0, index: 0 });
  // There are two sets, {0} and {1}. The last column of cells holds material 1.
  const cells = Array.from({ length: 25 }, (_, i) => Number(i % 5 === 4));
  const bytes = Uint8Array.from([2, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, ...cells]);
  const looks = initial_looks([{ id: 0, name: "air", color: "#00000000", rank: 1 }, { id: 1, name: "steel", color: "#ff8000", rank: 0 }]);
  const picture = slice_picture(axes, decode_slice(axes, place, bytes.buffer), looks);
  assert.deepEqual([picture.width, picture.height, ...picture.used], [512, 5, 1, 1]);
  const alpha = (x: number) => picture.pixels[4 * x + 3];
  assert.deepEqual([alpha(0), alpha(255), alpha(256), alpha(511)], [0, 0, 255, 255]);
  assert.deepEqual([...picture.pixels.subarray(4 * 300, 4 * 300 + 4)], [255, 128, 0, 255]);
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

test("straight views look along the axes, and z is up", () => {
  for (let axis = 0; axis < 3; ++axis)
    for (const above of [true, false]) {
      const { azimuth, elevation } = straight(axis, above);
      const { back } = projection_of(fitted([1, 1, 1], azimuth, elevation, 1), 100, 100);
      assert.ok(Math.abs(back[axis]! - (above ? 1 : -1)) < 1e-12);
    }
  const { right, up } = projection_of(fitted([1, 1, 1], straight(2, true).azimuth, 90, 1), 100, 100);
  assert.ok(Math.abs(right[0] - 1) < 1e-12 && Math.abs(up[1] - 1) < 1e-12);
});

test("flights turn the shorter way round and end where they should", () => {
  const a = { azimuth: 350, elevation: 0, distance: 4, target: [0, 0, 0] as Vec3 };
  const b = { ...a, azimuth: 10, distance: 1 };
  assert.deepEqual(between(a, b, 0.5), { azimuth: 360, elevation: 0, distance: 2, target: [0, 0, 0] });
  assert.equal((between(a, b, 1).azimuth + 360) % 360, 10);
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

test("a slow machine draws coarser bodies while they move, and a fast one draws everything", () => {
  const play = (ms: (pixels: number, coarser: number) => number) => {
    const ladder = make_ladder(1);
    for (let i = 0; i < 40; ++i)
      for (const rest of [0, 1] as const) ladder.measured(ladder.quality(rest), ms(ladder.quality(rest).ratio ** 2, ladder.quality(rest).coarser));
    return ladder;
  };
  const fast = play(() => 2);
  assert.deepEqual([fast.quality(0), fast.quality(1)], [fast.quality(2), fast.quality(2)]);
  const slow = play((pixels, coarser) => 10 * pixels + 60 / 4 ** coarser);
  assert.deepEqual(slow.quality(0), { ratio: 1, coarser: 1 });
  assert.deepEqual(slow.quality(2), { ratio: 2, coarser: 0 });
});

test("a single slow frame changes nothing", () => {
  const ladder = make_ladder(1);
  const before = ladder.quality(0);
  for (let i = 0; i < 20; ++i) ladder.measured(ladder.quality(0), i === 10 ? 90 : 20);
  assert.deepEqual(ladder.quality(0), before);
});

test("transparent bodies are drawn from far to near, after the planes and before the lines", () => {
  const orders = [100, 5, 2, 0].map(clear_order);
  assert.deepEqual(orders, [...orders].sort((a, b) => a - b));
  assert.ok(orders.every((order) => order > 16 && order < 30));
  assert.equal(new Set(orders).size, 4);
});
