// The page has the colours of the server's pictures: a set has the mean of its materials' premultiplied colours.
import assert from "node:assert/strict";
import test from "node:test";
import { color_of_set, initial_looks, looks_of_labels, shown_color } from "@page/base/materials";

const of_materials = initial_looks([
  { id: 0, name: "air", color: "#00000000", rank: 0 },
  { id: 1, name: "steel", color: "#8899aa", rank: 1 },
  { id: 2, name: "glass", color: "#ff000080", rank: 2 },
  { id: 3, name: "gold", color: "#ffd700", rank: 3 },
]);
const looks = looks_of_labels(
  of_materials.map((_, material) => ({ material, body: "" })),
  of_materials,
  new Map(),
);

test("a single material has its own colour", () => {
  assert.deepEqual(color_of_set([1], looks), [0x88, 0x99, 0xaa, 255]);
  assert.deepEqual(color_of_set([2], looks), [255, 0, 0, 128]);
  assert.deepEqual(color_of_set([0], looks), [0, 0, 0, 0]);
});

test("a set is the mean, weighted by opacity", () => {
  assert.deepEqual(color_of_set([1, 3], looks), [Math.round((0x88 + 0xff) / 2), Math.round((0x99 + 0xd7) / 2), Math.round(0xaa / 2), 255]);
  assert.deepEqual(color_of_set([0, 1], looks), [0x88, 0x99, 0xaa, 128]); // half of the set is air
});

test("a hidden material counts as if it were not in the set", () => {
  const hidden = looks.map((look, id) => (id === 3 ? { ...look, visible: false } : look));
  assert.deepEqual(color_of_set([1, 3], hidden), color_of_set([1], looks));
  assert.deepEqual(color_of_set([3], hidden), [0, 0, 0, 0]);
});

test("on the page air counts half in a set; a transparent material alone keeps its opacity", () => {
  assert.deepEqual(shown_color([0, 1], looks), [0x88, 0x99, 0xaa, 170]); // two thirds
  assert.deepEqual(shown_color([2], looks), [255, 0, 0, 128]);
  assert.deepEqual(shown_color([1, 3], looks), color_of_set([1, 3], looks));
  assert.deepEqual(shown_color([0], looks), [0, 0, 0, 0]);
});

test("bodies look like their material but where they differ from it; a hidden material hides its bodies", () => {
  const labels = [0, 1, 1, 3].map((material, label) => ({ material, body: label ? `body ${label}` : "" }));
  const own = new Map([
    [1, { color: [1, 2, 3] as const, opacity: 0.5 }],
    [2, { visible: false }],
  ]);
  const bodies = looks_of_labels(labels, of_materials, own);
  assert.deepEqual(bodies[1], { color: [1, 2, 3], opacity: 0.5, visible: true, material: 1 });
  assert.deepEqual(bodies[2], { ...of_materials[1]!, visible: false, material: 1 });
  assert.deepEqual(bodies[3], { ...of_materials[3]!, material: 3 });
  const without_steel = of_materials.map((look, id) => (id === 1 ? { ...look, visible: false } : look));
  assert.deepEqual(looks_of_labels(labels, without_steel, own).map(({ visible }) => visible), [true, false, false, true]);
});

test("bodies of one material count as one in a set, so that a grid that keeps bodies looks like one that does not", () => {
  const labels = [0, 1, 1, 1, 3].map((material) => ({ material, body: "" }));
  const bodies = looks_of_labels(labels, of_materials, new Map());
  assert.deepEqual(shown_color([0, 1, 2, 3, 4], bodies), shown_color([0, 1, 3], looks));
  assert.deepEqual(shown_color([1, 2, 3], bodies), shown_color([1], looks));
  const red = looks_of_labels(labels, of_materials, new Map([[1, { color: [255, 0, 0] as const }], [3, { visible: false }]]));
  assert.deepEqual(color_of_set([1, 2, 3], red), [Math.round((255 + 0x88) / 2), Math.round(0x99 / 2), Math.round(0xaa / 2), 255]);
});
