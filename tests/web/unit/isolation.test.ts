// What "Go there" isolates is shown in full and the rest is faint, whatever people have chosen before; that stays as it was.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Amount, BodyStats, GridInfo, OverlapReport } from "@page/base/grid";
import { type LabelLook, shown_color } from "@page/base/materials";
import { small_labels, with_overlaps, with_room } from "@page/state/boxes";
import { change_bodies, show_only } from "@page/state/bodies";
import { go_to_finding } from "@page/visits/go_there";
import { isolated_text, labels_named, labels_of_overlap, looks_around } from "@page/state/isolation";
import { named_places } from "@page/state/named_places";
import { Viewer } from "@page/state/viewer";
import { substance_of } from "@page/overview/sight/layers";
import { escape } from "@page/views/actions";

const cells = [100, 80, 60];
const info = {
  id: "grid",
  units: "mm",
  grid: { cells, sample: [0.5, 0.5, 0.5], axes: cells.map((n) => ({ type: "uniform", min: 0, step: 2, first: 0, cells: n })) },
  materials: [
    { id: 0, name: "air", color: "#00000000" },
    { id: 1, name: "steel", color: "#3366cc" },
    { id: 2, name: "wood", color: "#884400" },
  ],
  file: { hash: "0" },
  report: { bodies: [], inputs: [], warnings: [], scene: { bodies: [{ name: "wall", material: "steel" }, { name: "pipe", material: "steel" }] } },
} as unknown as GridInfo;
const apart = { ...info, labels: [{ material: 0, body: "" }, { material: 1, body: "wall" }, { material: 1, body: "pipe" }, { material: 2, body: "steel" }] } as GridInfo;
const whole = (body: string, material = 1) => ({ material, body });
const part = (body: string, material = 1) => ({ ...whole(body, material), overlap: true as const });
const common: Pick<OverlapReport, "cells" | "box" | "at"> = { cells: 3, box: [0, 0, 0, 3, 1, 1], at: [1, 1, 1] };
const overlapping: GridInfo = {
  ...info,
  labels: [whole("", 0), whole("door"), whole("pipe"), part("pipe"), whole("wall"), part("wall"), whole("lid", 2), part("lid", 2)],
  report: { ...info.report, overlaps: { pairs: 2, list: [{ ...common, bodies: ["pipe", "wall"], owner: "wall" }, { ...common, bodies: ["pipe", "lid"], owner: null }] } },
};

test("what is isolated is opaque and in its colour, also when it was hidden; the rest is faint, and what was hidden of it stays hidden", () => {
  const viewer = new Viewer(apart);
  change_bodies(viewer, [1, 2], { visible: false, opacity: 0.3 });
  change_bodies(viewer, [2], { color: [1, 2, 3] });
  const chosen = viewer.body_looks.value;
  viewer.isolated.value = { labels: [2], box: null };
  const seen = viewer.shown_looks.value.map(({ visible, opacity, faint }) => [visible, opacity, faint]);
  assert.deepEqual(seen, [[true, 0, true], [false, 0.3, true], [true, 1, false], [true, 1, true]]);
  assert.deepEqual(viewer.shown_looks.value[2]!.color, [1, 2, 3]);
  assert.equal(viewer.body_looks.value, chosen);
  escape(viewer);
  assert.equal(viewer.shown_looks.value, viewer.label_looks.value);
});

test("in slices what is faint is hardly there, and beside what is isolated it does not count", () => {
  const look = (material: number, color: LabelLook["color"]): LabelLook => ({ material, color, visible: true, opacity: 1 });
  const looks = looks_around([look(0, [0, 0, 0]), look(1, [255, 0, 0]), look(2, [0, 0, 255])], { labels: [2], box: null }, apart.labels!);
  assert.ok(shown_color([1], looks)[3] < 50);
  assert.deepEqual(shown_color([2], looks), [0, 0, 255, 255]);
  const [red, , blue] = shown_color([1, 2], looks);
  assert.ok(blue > 5 * red);
});

test("names stand for bodies, or for the material of a body that has no label of its own, and never for the background", () => {
  assert.deepEqual(labels_named(apart, ["pipe", "wall"]), [1, 2]);
  assert.deepEqual(labels_named(apart, ["steel"]), [3], "a body's name goes before that of a material");
  assert.deepEqual(labels_named(info, ["pipe", "wall"]), [1]);
  assert.deepEqual(labels_named(info, ["wood", "air", "nothing"]), [2]);
  assert.deepEqual(labels_named({ ...info, report: { ...info.report, scene: null } }, ["steel", "pipe"]), [1]);
});

test("it is said what is isolated: a few by their names, many by their number", () => {
  const name = (label: number) => `body ${label}`;
  const text = (labels: number[], overlaps = overlapping.report.overlaps) => isolated_text({ labels, box: null }, { labels: overlapping.labels!, overlaps }, name, true);
  assert.equal(text([1, 2]), "body 1, body 2");
  assert.equal(text([1, 2, 4, 6]), "4 bodies");
  assert.equal(text([]), "a place");
  assert.equal(text([2, 4, 5]), "the overlap of body 2 and body 4");
  const { list } = overlapping.report.overlaps!;
  assert.equal(text([2, 4, 5], { pairs: 3, list: [...list, { ...common, bodies: ["door", "wall"], owner: "wall" }] }), "the overlaps of wall", "a label does not say with which body");
  assert.equal(text([2, 4, 5], { pairs: 9, list }), "the overlaps of wall", "not all pairs are listed");
  assert.equal(text([2, 3, 5, 6, 7]), "all overlaps");
});

test("the cells that two bodies have in common are labels of their own: of the body that owns them, or of all where a third one owns some", () => {
  assert.deepEqual(labels_of_overlap(overlapping, ["pipe", "wall"]), [5]);
  assert.deepEqual(labels_of_overlap(overlapping, ["pipe", "lid"]), [3, 5, 7]);
  assert.deepEqual(labels_of_overlap(apart, ["pipe", "wall"]), []);
  assert.deepEqual(labels_named(overlapping, ["wood"]), [6], "what lies in others is no body of its own");
});

test("an overlap that is gone to is solid in its colour, in bodies of glass; a body that is gone to is whole; a body's look is that of all its cells", () => {
  const viewer = new Viewer(overlapping);
  change_bodies(viewer, [4], { color: [1, 2, 3] });
  assert.deepEqual(viewer.label_looks.value[5]!.color, [1, 2, 3]);
  go_to_finding(viewer, { at: [71, 51, 51], box: [35, 25, 25, 37, 29, 26], bodies: ["pipe", "wall"], kind: "overlap" });
  assert.deepEqual(viewer.isolated.value!.labels, [2, 4, 5]);
  const seen = () => viewer.shown_looks.value.slice(1).map(({ faint, glass }) => (faint ? "faint" : glass ? "glass" : "solid"));
  assert.deepEqual(seen(), ["faint", "glass", "glass", "glass", "solid", "faint", "faint"]);
  const sight = { looks: viewer.shown_looks.value, mode: "cut" as const, small: new Set([2, 3, 4, 5]) };
  assert.deepEqual([2, 4, 5].map((label) => substance_of(sight, label)), ["glass", "glass", "solid"], "small bodies as well");
  assert.equal(substance_of({ ...sight, mode: "glass", small: new Set() }, 5), "solid", "in glass, too");
  assert.notDeepEqual(viewer.shown_looks.value[5]!.color, viewer.shown_looks.value[4]!.color);
  viewer.isolated.value = { labels: [4], box: null };
  assert.deepEqual(seen(), ["faint", "faint", "faint", "solid", "solid", "faint", "faint"]);
  const in_glass = { looks: viewer.shown_looks.value, mode: "glass" as const, small: new Set<number>() };
  assert.deepEqual([2, 4, 5].map((label) => substance_of(in_glass, label)), ["faint", "glass", "glass"]);
  show_only(viewer, [4]);
  assert.deepEqual(viewer.label_looks.value.map(({ visible }) => visible), [false, false, false, false, true, true, false, false]);
  assert.deepEqual(viewer.wholes, [0, 1, 2, 4, 6]);
  assert.deepEqual(named_places(viewer).map(({ ids }) => ids), [[1], [2], [4], [6], [1], [2]]);
});

test("what a body fills is with what lies in other bodies as well", () => {
  const amount = (cells: number, box: Amount["box"]) => ({ label: 0, name: "", material: 0, cells, volume: cells / 2, box });
  const all = with_overlaps([amount(8, null), amount(3, [0, 0, 0, 3, 1, 1]), { ...amount(4, [2, 0, 0, 4, 2, 1]), overlap: true }, amount(0, null), { ...amount(2, [0, 0, 0, 2, 1, 1]), overlap: true }]);
  assert.deepEqual(all.map(({ cells }) => cells), [8, 7, 4, 2, 2]);
  assert.deepEqual(all[1]!.box, [0, 0, 0, 4, 2, 1]);
  assert.equal(all[1]!.volume, 3.5);
  assert.deepEqual(all[3]!.box, [0, 0, 0, 2, 1, 1]);
  const large: BodyStats[] = [{ ...amount(2 ** 60, null), cells_text: String(2n ** 60n + 1n) }, { ...amount(3, null), overlap: true }];
  assert.equal(with_overlaps(large)[0]!.cells_text, String(2n ** 60n + 4n));
});

test("a finding is gone to: its box is framed with room, and not its body; the crosshair is where it says", () => {
  const viewer = new Viewer(apart);
  viewer.views = [{ axis: 2, width: 500, height: 400 }];
  go_to_finding(viewer, { at: [71, 51, 51], box: [35, 25, 25, 37, 29, 26], bodies: ["wall", "pipe"] });
  assert.deepEqual(viewer.cell.value, [35, 25, 25]);
  assert.deepEqual(viewer.centre.value, [72, 54, 51]);
  assert.deepEqual(viewer.isolated.value, { labels: [1, 2], box: [35, 25, 25, 37, 29, 26] });
  const [x] = viewer.visited.value!;
  assert.ok(x.min < 70 && x.max > 74 && x.max - x.min < 100);
  assert.ok(viewer.zoom.value > 3);
  const fits = with_room(viewer.axes, [0, 0, 0, 100, 80, 60], 0.5);
  assert.deepEqual(fits, [{ min: 0, max: 200 }, { min: 0, max: 160 }, { min: 0, max: 120 }], "room ends where the domain does");
});

test("who chooses by hand what is seen sees that", () => {
  const viewer = new Viewer(apart);
  viewer.isolated.value = { labels: [2], box: null };
  change_bodies(viewer, [1], { color: [9, 9, 9] });
  assert.notEqual(viewer.isolated.value, null, "a colour hides nothing");
  change_bodies(viewer, [1], { visible: false });
  assert.equal(viewer.isolated.value, null);
});

test("what is small beside the largest is known by its box", () => {
  const { axes } = new Viewer(info);
  const amount = (x: number, y: number) => ({ cells: 1, volume: 1, box: x ? ([0, 0, 0, x, y, 1] as [number, number, number, number, number, number]) : null });
  const small = (...sizes: [number, number][]) => [...small_labels(axes, sizes.map(([x, y]) => amount(x, y)), (label) => label === 0)];
  assert.deepEqual(small([100, 80], [40, 40], [5, 1], [2, 6], [0, 0]), [2], "of 40 cells those up to 5; the background and what has no cells are none");
  assert.deepEqual(small([100, 80], [3, 3], [3, 3]), [], "of equals none is small");
});
