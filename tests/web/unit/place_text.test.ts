// Places as text: what people write is understood by one rule, and what the page copies leads back to the same cell.
import assert from "node:assert/strict";
import test from "node:test";
import { Axis } from "@page/base/axis";
import type { GridInfo, Index3 } from "@page/base/grid";
import { named_places, places_named, shared_material } from "@page/state/named_places";
import { cell_text, coordinates_text, spots_of } from "@page/state/place_text";
import { random_of } from "./random";

const axis = (min: number, step: number, cells: number) => new Axis({ type: "uniform", min, step, first: 0, cells }, 0.5);
const axes = [axis(0, 0.5, 20), axis(-10, 1, 40), axis(0, 2, 50)] as const; // to 10, 30 and 100 mm
const here: Index3 = [7, 8, 9];
const read = (text: string) => spots_of(text, axes, "mm", here);
const first = (text: string) => read(text)[0]?.cell;

test("three numbers are coordinates, however they are parted", () => {
  for (const text of ["1.5, 2, 90", "1.5,2,90", "1.5 2 90", " (1.5; 2; 90) ", "[1.5,\t2.0,\n9e1]", "x = 1.5, y = 2, z = 90", "x1.5 y2 z90", "Z=90 x=1.5 y=2"])
    assert.deepEqual(first(text), [3, 12, 45], text);
});

test("a comma is a decimal comma only where there are three numbers by that", () => {
  assert.deepEqual(first("1,5; 2,5; 90"), [3, 12, 45]);
  assert.deepEqual(first("1,5 2,5 90,0"), [3, 12, 45]);
  assert.deepEqual(first("1,5,90"), [2, 15, 45]);
});

test("units behind the numbers, and this page's own way of writing numbers", () => {
  assert.deepEqual(first("0.15 0.2 9 cm"), [3, 12, 45]);
  assert.deepEqual(first("1500 µm, 2mm, 0.09 m"), [3, 12, 45]);
  assert.deepEqual(first("1\u202f500.0 µm, −2 mm, 90\u202f000 µm"), [3, 8, 45]);
});

test("a cell is one where the text says so; whole numbers without a unit may be either, the coordinates first", () => {
  for (const text of ["cell 3, 12, 45", "Cell (3 12 45)", "cells: 3;12;45", "3, 12, 45 cell", "i = 3, j = 12, k = 45"]) {
    assert.deepEqual(read(text).map(({ by, cell }) => [by, cell]), [["cell", [3, 12, 45]]], text);
  }
  assert.deepEqual(read("3, 12, 45").map(({ by, cell }) => [by, cell]), [["coordinates", [6, 22, 22]], ["cell", [3, 12, 45]]]);
  assert.equal(read("3, 12, 45 mm").length, 1);
  assert.equal(read("9, 25, 60").length, 1, "there is no such cell");
});

test("what is not named stays", () => {
  assert.deepEqual(first("z = 90"), [7, 8, 45]);
  assert.deepEqual(first("cell k = 4, i = 2"), [2, 8, 4]);
});

test("a place outside leads to the nearest one, and says what is outside", () => {
  const [spot] = read("4, 31, 5");
  assert.deepEqual(spot!.cell, [8, 39, 2]);
  assert.match(spot!.outside!, /^y = 31\.0 mm is outside the grid, which goes from −10\.0 to 30\.0 mm: the nearest place is shown\.$/);
  assert.deepEqual(read("10, 30, 100").map(({ cell, outside }) => [cell, outside])[0], [[19, 39, 49], null], "the upper end is inside");
  assert.match(read("cell 20, 0, 0")[0]!.outside!, /^Cell 20, 0, 0 is outside the grid/);
});

test("what is no place has no meaning", () => {
  for (const text of ["", "steel", "1", "1, 2", "1, 2, 3, 4", "x = 1, x = 2", "x = 1, 2, 3", "cell 1.5, 2, 3", "1, 2, 3 stone", "bolt 1 2 3", "cell 1, 2, 3 mm"])
    assert.deepEqual(read(text), [], text);
});

test("what is copied leads back to the cell, on graded axes and far from 0 too", () => {
  const random = random_of(5);
  const planes = [0];
  for (let i = 0; i < 200; ++i) planes.push(planes[i]! + 1e-7 + random() ** 8);
  const graded = new Axis({ type: "graded", planes }, 0);
  const fine = [graded, axis(1e6 / 3, 1e-5 / 3, 1000), axis(-0.7, 1 / 700, 1000)] as const;
  for (let n = 0; n < 200; ++n) {
    const cell = fine.map(({ cells }) => Math.floor(random() * cells)) as Index3;
    for (const text of [cell_text(cell), coordinates_text(fine, cell, "in")]) assert.deepEqual(spots_of(text, fine, "in", here)[0]!.cell, cell, text);
  }
  assert.equal(coordinates_text(axes, [3, 12, 45], "mm"), "1.75, 2.5, 91 mm");
});

test("names: the whole one first, then what begins with the text, also within a path; parts hold what is below them", () => {
  const bodies = ["/car/front/wheel", "/car/front/wheel#2", "/car/wheelbase", "road", "spare wheel"];
  const labels = [{ material: 0, body: "" }, ...bodies.map((body) => ({ material: 1, body }))];
  const info = { materials: [{ name: "air" }, { id: 1, name: "steel" }] } as unknown as GridInfo;
  const list = named_places({ labels, info, keeps_bodies: true });
  const found = (text: string) => places_named(list, text, 8).map(({ name, kind }) => `${name}: ${kind}`);
  assert.deepEqual(found("WHEEL"), ["/car/front/wheel: body", "/car/front/wheel#2: body", "/car/wheelbase: body", "spare wheel: body"]);
  assert.deepEqual(found("front"), ["/car/front: part of 2 bodies", "/car/front/wheel: body", "/car/front/wheel#2: body"]);
  assert.deepEqual(found("/car/front/wheel")[0], "/car/front/wheel: body");
  assert.deepEqual([found("steel"), found("air"), found(" ")], [["steel: material"], [], []]);
  assert.deepEqual(places_named(list, "/car/front", 1)[0]!.ids, [1, 2]);
});

test("where a file keeps materials, the name of a body leads to its material, and says so where others share it", () => {
  const materials = ["air", "steel", "glass"].map((name, id) => ({ id, name }));
  const bodies = [["base", "steel"], ["rib", "steel"], ["wall", "glass"], ["steel", "steel"]].map(([name, material]) => ({ name, material }));
  const info = { materials, report: { scene: { bodies } } } as unknown as GridInfo;
  const list = named_places({ labels: [], info, keeps_bodies: false });
  assert.deepEqual(places_named(list, "base", 8), [{ name: "base", kind: "body; leads to all of steel", of: "materials", ids: [1] }]);
  assert.deepEqual(places_named(list, "wall", 8).map(({ kind, ids }) => [kind, ids]), [["body", [2]]]);
  assert.deepEqual(places_named(list, "steel", 8).map(({ kind }) => kind), ["material"]);
  assert.deepEqual([shared_material({ info, keeps_bodies: false }, "rib"), shared_material({ info, keeps_bodies: false }, "wall"), shared_material({ info, keeps_bodies: true }, "rib")], ["steel", null, null]);
});
