// The page has the colours of the server's pictures: a set has the mean of its materials' premultiplied colours.
import assert from "node:assert/strict";
import test from "node:test";
import { color_of_set, initial_looks, shown_color } from "@page/base/materials";

const looks = initial_looks([
  { id: 0, name: "air", color: "#00000000", rank: 0 },
  { id: 1, name: "steel", color: "#8899aa", rank: 1 },
  { id: 2, name: "glass", color: "#ff000080", rank: 2 },
  { id: 3, name: "gold", color: "#ffd700", rank: 3 },
]);

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
