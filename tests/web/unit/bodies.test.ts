// How bodies look: what they have of their own is kept, and nothing else.
import assert from "node:assert/strict";
import test from "node:test";
import type { GridInfo } from "@page/base/grid";
import { type Branch, type Leaf, is_branch, part_tree } from "@page/base/part_tree";
import { matching, ordered } from "@page/panels/look_list";
import { change_bodies, show_only, show_all_bodies, with_change } from "@page/state/bodies";
import { address_of, read_address } from "@page/state/permalink";
import { Viewer } from "@page/state/viewer";

const uniform = { type: "uniform", min: 0, step: 1, first: 0, cells: 8 };
const info = {
  id: "assembly",
  units: "mm",
  ray_axis: "z",
  grid: { min: [0, 0, 0], max: [8, 8, 8], cells: [8, 8, 8], sample: [0.5, 0.5, 0.5], axes: [uniform, uniform, uniform], cells_text: "512" },
  materials: [
    { id: 0, name: "air", color: "#00000000", rank: 0 },
    { id: 1, name: "steel", color: "#8899aa", rank: 1 },
    { id: 2, name: "rubber", color: "#222222", rank: 2 },
  ],
  labels: [
    { material: 0, body: "" },
    { material: 1, body: "rim 1" },
    { material: 2, body: "tyre 1" },
    { material: 1, body: "rim 2" },
    { material: 2, body: "tyre 2" },
  ],
  levels: [],
  file: { bytes: 1, version: "1.0", hash: "0" },
  crossings: 0,
  bits_per_crossing: 0,
  report: { bodies: [], crossings: 0, warnings: [], inputs: [] },
} as unknown as GridInfo;

const visible = (viewer: Viewer) => viewer.label_looks.value.flatMap((look, label) => (look.visible ? [label] : []));

function read(address: string): Viewer {
  (globalThis as { location?: unknown }).location = { hash: address };
  const viewer = new Viewer(info);
  read_address(viewer);
  return viewer;
}

test("a body that looks like its material again is forgotten", () => {
  const hidden = with_change(new Map(), [1, 2], () => ({ visible: false }));
  assert.deepEqual([...hidden], [[1, { visible: false }], [2, { visible: false }]]);
  assert.deepEqual([...with_change(hidden, [1], () => ({ visible: true }))], [[2, { visible: false }]]);
  const red = with_change(hidden, [1], () => ({ color: [255, 0, 0] }));
  assert.deepEqual(with_change(red, [1], () => ({ visible: true })).get(1), { color: [255, 0, 0] });
  assert.deepEqual([...hidden.keys()], [1, 2], "the map that was given stays as it is");
});

test("bodies are hidden, shown alone and shown again", () => {
  const viewer = new Viewer(info);
  change_bodies(viewer, [2, 3], { visible: false });
  assert.deepEqual(visible(viewer), [0, 1, 4]);
  show_only(viewer, [3]);
  assert.deepEqual(visible(viewer), [3]);
  show_all_bodies(viewer);
  assert.deepEqual(visible(viewer), [0, 1, 2, 3, 4]);
  assert.equal(viewer.body_looks.value.size, 0);
});

test("a body of a hidden material comes back with its material", () => {
  const viewer = new Viewer(info);
  viewer.looks.value = viewer.looks.value.map((look, id) => ({ ...look, visible: id !== 1 }));
  assert.deepEqual(visible(viewer), [0, 2, 4]);
  show_only(viewer, [3]);
  assert.deepEqual(visible(viewer), [3]);
});

test("the address keeps how bodies look", () => {
  const before = new Viewer(info);
  change_bodies(before, [1, 2, 4], { visible: false });
  change_bodies(before, [2, 3], { color: [255, 0, 16] });
  change_bodies(before, [3], { opacity: 0.5 });
  before.panel.value = "bodies";
  const address = address_of(before);
  assert.match(address, /hidden=1-2,4&body=2:ff0010:;3:ff0010:0\.5/);
  const after = read(address);
  assert.deepEqual(new Map([...after.body_looks.value].sort()), new Map([...before.body_looks.value].sort()));
  assert.equal(after.panel.value, "bodies");
  assert.equal(address_of(after), address);
});

test("nonsense about bodies in an address is left out", () => {
  assert.deepEqual([...read("#hidden=x,7,3&body=9:ffffff:;1:red:;2:ffffff:7;:;x").body_looks.value].sort(), [[2, { color: [255, 255, 255] }], [3, { visible: false }]]);
});

test("lists are filtered by what is read in them, and ordered by name or cells", () => {
  const items = [["wheel 10", "steel", 5], ["Axle", "steel", 7], ["wheel 9", "rubber", 6]].map(([name, beside, cells]) => ({
    name: name as string,
    beside: beside as string,
    amount: { cells: cells as number, volume: 1, box: null },
  }));
  const names = (list: readonly { name: string }[]) => list.map(({ name }) => name).join();
  assert.equal(names(matching(items, " AXLE")), "Axle");
  assert.equal(names(matching(items, "steel")), "wheel 10,Axle");
  assert.equal(names(matching(items, " ")), "wheel 10,Axle,wheel 9");
  assert.equal(names(ordered(items, "name")), "Axle,wheel 9,wheel 10");
  assert.equal(names(ordered(items, "most")), "Axle,wheel 9,wheel 10");
  assert.equal(names(ordered(items, "fewest")), "wheel 10,wheel 9,Axle");
  assert.equal(names(ordered(items, "own")), "wheel 10,Axle,wheel 9");
});

test("names that are paths are a tree, and chains of branches are one", () => {
  const shown = (list: readonly (Branch | Leaf)[]): string =>
    list.map((child) => (is_branch(child) ? `${child.name}${JSON.stringify(child.places)}(${shown(child.children)})` : `${child.name}:${child.place}`)).join(" ");
  const tree = (...names: string[]) => {
    const found = part_tree(names);
    return found && shown(found);
  };
  assert.equal(tree("air", "rim", "tyre"), null);
  assert.equal(tree("air", "/rim", "/tyre"), null);
  assert.equal(tree("air", "/as1/rod/nut", "/as1/rod/nut#2", "/as1/plate", "wall"), "air:0 as1[1,2,3](rod[1,2](nut:1 nut#2:2) plate:3) wall:4");
  assert.equal(tree("/a/b/c/d", "/a/b/c/e"), "a / b / c[0,1](d:0 e:1)");
  assert.equal(tree("/a", "/a/b", "/a/c", "/ab"), "a[0,1,2](a:0 b:1 c:2) ab:3");
  assert.equal(tree("/a/b", "/a", "/a/c"), "a[0,1,2](b:0 a:1 c:2)");
  assert.equal(tree("/нет\\/да/部品\\*", "/нет\\/да/\\\\"), "нет/да[0,1](部品*:0 \\:1)");
  assert.equal(tree("/a//b", "/cut off\\", "a/b"), "a / [0](b:0) cut off\\:1 a/b:2");
});
