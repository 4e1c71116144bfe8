// Surfaces of the overview are closed for every material and enclose nearly the right volume, and touching bodies fit together.
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Faces, count_quads, faces_of, make_net, relax } from "@page/overview/surface_nets";
import type { Volume } from "@page/overview/volume";

type Size = [number, number, number];

function volume_of(size: Size, label: (x: number, y: number, z: number) => number): Volume {
  const labels = new Uint8Array(size[0] * size[1] * size[2]);
  for (let z = 0, at = 0; z < size[2]; ++z)
    for (let y = 0; y < size[1]; ++y) for (let x = 0; x < size[0]; ++x, ++at) labels[at] = label(x + 0.5, y + 0.5, z + 0.5);
  return { size, labels };
}

// As in the pyramid, a coarse cell has the largest label of the 4 x 4 x 4 cells below it.
function pooled(fine: Volume): Volume {
  const size = fine.size.map((n) => n / 4) as Size;
  return volume_of(size, (x, y, z) => {
    let most = 0;
    for (let k = 0; k < 64; ++k) {
      const place = [4 * Math.floor(x) + (k & 3), 4 * Math.floor(y) + ((k >> 2) & 3), 4 * Math.floor(z) + (k >> 4)];
      most = Math.max(most, fine.labels[(place[2]! * fine.size[1] + place[1]!) * fine.size[0] + place[0]!]!);
    }
    return most;
  });
}

function surfaces(volume: Volume, inward = 0, rounds = 8) {
  const { net, vertex_at } = make_net(volume, { strength: (label) => label, inward });
  relax(net, rounds);
  return { net, faces: faces_of(volume, net, vertex_at) };
}

type Positions = Float32Array;
const corner = (positions: Positions, { vertices, indices }: Faces, i: number) =>
  positions.subarray(3 * vertices[indices[i]!]!, 3 * vertices[indices[i]!]! + 3);

function enclosed(positions: Positions, faces: Faces): number {
  let sum = 0;
  for (let t = 0; t < faces.indices.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((i) => corner(positions, faces, t + i)) as [Positions, Positions, Positions];
    sum += a[0]! * (b[1]! * c[2]! - b[2]! * c[1]!) + a[1]! * (b[2]! * c[0]! - b[0]! * c[2]!) + a[2]! * (b[0]! * c[1]! - b[1]! * c[0]!);
  }
  return sum / 6;
}

// Every directed edge belongs to as many triangles as its opposite.
function assert_closed({ vertices, indices }: Faces): void {
  const edges = new Map<string, number>();
  for (let t = 0; t < indices.length; t += 3)
    for (let i = 0; i < 3; ++i) {
      const [a, b] = [vertices[indices[t + i]!]!, vertices[indices[t + ((i + 1) % 3)]!]!];
      const name = a < b ? `${a} ${b}` : `${b} ${a}`;
      edges.set(name, (edges.get(name) ?? 0) + (a < b ? 1 : -1));
    }
  for (const [name, balance] of edges) assert.equal(balance, 0, `edge ${name}`);
}

const sphere = (size: Size, radius: number) =>
  volume_of(size, (x, y, z) => Number(Math.hypot(x - size[0] / 2, y - size[1] / 2, z - size[2] / 2) < radius));
const ball = (radius: number) => (4 / 3) * Math.PI * radius ** 3;

test("a sphere's surface is closed, faces outward, and encloses the sphere's volume", () => {
  const { net, faces } = surfaces(sphere([48, 48, 48], 20));
  assert.deepEqual(faces.map((f) => f.material), [1]);
  assert_closed(faces[0]!);
  assert.ok(Math.abs(enclosed(net.positions, faces[0]!) / ball(20) - 1) < 0.025);
});

test("a sphere's vertices lie near it and its facets are smooth", () => {
  const { net, faces } = surfaces(sphere([48, 48, 48], 20));
  for (const v of faces[0]!.vertices) {
    const radius = Math.hypot(net.positions[3 * v]! - 24, net.positions[3 * v + 1]! - 24, net.positions[3 * v + 2]! - 24);
    assert.ok(Math.abs(radius - 20) < 0.4, `radius ${radius}`);
  }
});

test("bodies don't get thicker although every coarse cell that they touch is theirs", () => {
  const coarse = pooled(sphere([160, 160, 160], 66));
  const { net, faces } = surfaces(coarse, (1 - 1 / 4) / 2);
  assert_closed(faces[0]!);
  assert.ok(Math.abs(enclosed(net.positions, faces[0]!) / ball(66 / 4) - 1) < 0.03);
  const plain = surfaces(coarse, 0);
  assert.ok(enclosed(plain.net.positions, plain.faces[0]!) / ball(66 / 4) > 1.05);
});

test("touching bodies share the vertices between them, and each is closed", () => {
  const volume = volume_of([30, 20, 20], (x, y, z) => (Math.hypot(y - 10, z - 10) < 7 && x > 4 && x < 26 ? (x + 0.2 * y < 16 ? 1 : 2) : 0));
  const { net, faces } = surfaces(volume);
  assert.deepEqual(faces.map((f) => f.material).sort(), [1, 2]);
  for (const f of faces) assert_closed(f);
  const of_second = new Set(faces[1]!.vertices);
  assert.ok(faces[0]!.vertices.filter((v) => of_second.has(v)).length > 100);
  // The same triangles bound both bodies where they touch, so the volumes of the bodies add up to that of the whole.
  const whole = surfaces({ ...volume, labels: volume.labels.map((l) => Math.min(l, 1)) }, 0, 0);
  const apart = surfaces(volume, 0, 0);
  const total = apart.faces.reduce((sum, f) => sum + enclosed(apart.net.positions, f), 0);
  assert.ok(Math.abs(total - enclosed(whole.net.positions, whole.faces[0]!)) < 1e-3);
  assert.ok(net.positions.every(Number.isFinite));
});

test("bodies at the border are closed there by flat faces", () => {
  const { net, faces } = surfaces(volume_of([6, 5, 4], () => 3), 0.5);
  assert_closed(faces[0]!);
  assert.ok(Math.abs(enclosed(net.positions, faces[0]!) - 120) < 1e-3);
});

test("sheets and wires one cell thick keep some of their thickness", () => {
  const sheet = surfaces(volume_of([20, 20, 9], (x, y, z) => Number(Math.floor(z) === 4 && x > 3 && x < 17 && y > 3 && y < 17)), 0.5);
  assert_closed(sheet.faces[0]!);
  assert.ok(enclosed(sheet.net.positions, sheet.faces[0]!) > 0.25 * 14 * 14);
  const wire = surfaces(volume_of([24, 9, 9], (_x, y, z) => Number(Math.floor(z) === 4 && Math.floor(y) === 4)), 0.5);
  assert_closed(wire.faces[0]!);
  assert.ok(enclosed(wire.net.positions, wire.faces[0]!) > 0.2 * 24);
});

test("cells that touch along an edge or at a corner alone still make closed surfaces", () => {
  for (const other of [[3, 3, 2], [3, 3, 3]]) {
    const { faces } = surfaces(
      volume_of([6, 6, 6], (x, y, z) => Number([x, y, z].every((c) => Math.floor(c) === 2) || [x, y, z].every((c, d) => Math.floor(c) === other[d]))),
    );
    assert_closed(faces[0]!);
    assert.equal(faces[0]!.indices.length, 12 * 2 * 3);
  }
});

test("the quads of each material are counted beforehand", () => {
  const counts = count_quads(volume_of([4, 1, 1], (x) => (x < 2 ? 1 : x < 3 ? 2 : 0)));
  assert.deepEqual([...counts], [[1, 10], [2, 6]]);
});

test("where there is no body there is no surface", () => {
  assert.deepEqual(surfaces(volume_of([3, 3, 3], () => 0)).faces, []);
});
