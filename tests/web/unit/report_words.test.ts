// The sentence that says whether to care is about the worst that was found.
import assert from "node:assert/strict";
import test from "node:test";
import type { BodyReport, GridInfo, Hole } from "@page/base/grid";
import { body_cells, care_of, compression, levels_text, size_text } from "@page/panels/report_words";
import { places_found } from "@page/state/places";

const hole = (diameter: number, cells: number): Hole => ({ at: [0, 0, 0], edges: 3, diameter, diameter_cells: cells, cap_area: 1 });
const body = (name: string, more: Partial<BodyReport> = {}): BodyReport => ({
  name,
  facets: 12,
  degenerate: 0,
  duplicates: 0,
  shells: 1,
  fill: [{ rule: "nonzero", shells: 1, why: "asked for" }],
  holes: [],
  flips: [],
  cells: 8,
  ...more,
});
const info = (bodies: BodyReport[], warnings: string[] = []): GridInfo =>
  ({
    units: "mm",
    grid: { cells: [10000, 10000, 10000] },
    file: { bytes: 15645947 },
    report: { bodies, warnings, crossings: 0, inputs: [] },
  }) as unknown as GridInfo;

test("closed bodies with cells are nothing to worry about", () => {
  assert.deepEqual(care_of(info([body("hull")])), { level: "fine", text: "The surface of “hull” is closed." });
  assert.deepEqual(care_of(info([body("a"), body("b")])), { level: "fine", text: "All 2 bodies are closed and have cells." });
});

test("a wide hole is a reason to look", () => {
  const care = care_of(info([body("hull", { holes: [hole(0.3, 2.5), hole(4, 33.21), hole(1, 8)] }), body("deck")]));
  assert.deepEqual(care, {
    level: "look", text: "Look here: “hull” is open. The widest hole is 4.000 mm wide, 33.2 cells. Caps close all of them, and a cap is a guess.",
  });
});

test("holes narrower than two cells are harmless", () => {
  const care = care_of(info([body("hull", { holes: [hole(0.1, 1.99), hole(0.1, 0.5)] })], ["is open"]));
  assert.deepEqual(care, { level: "look", text: "“hull” has 2 holes narrower than 2 cells, which caps close." });
});

test("one harmless hole is named as one, and units are written as people write them", () => {
  const one = (diameter: number, cells: number) => ({ ...info([body("hull", { holes: [hole(diameter, cells)] })]), units: "um" });
  assert.equal(care_of(one(0.1, 1.99)).text, "“hull” has a hole narrower than 2 cells, which a cap closes.");
  assert.match(care_of(one(4, 33)).text, /4\.000 µm wide/);
  assert.match(places_found(one(4, 33))[0]!.text, /4\.000 µm wide/);
});

test("a body without cells matters more than a hole", () => {
  const care = care_of(info([body("hull", { holes: [hole(4, 33)] }), body("bolt", { cells: 0 })]));
  assert.deepEqual(care, { level: "bad", text: "Look here: “bolt” owns no cell. Is it in the right place, and wider than a cell?" });
});

test("of many bodies only some are named", () => {
  const empty = ["a", "b", "c", "d", "e"].map((name) => body(name, { cells: 0 }));
  assert.match(care_of(info(empty)).text, /“a”, “b”, “c” and 2 more own no cell\. Are they/);
  assert.match(care_of(info(empty.slice(0, 2))).text, /“a” and “b” own/);
});

test("facets that face opposite ways are probably fine, and other warnings are counted", () => {
  const care = care_of(info([body("hull", { flips: [{ at: [0, 0, 0], edges: 72 }] })], ["has facets"]));
  assert.equal(care.level, "look");
  assert.match(care.text, /“hull” has facets that face the opposite way from their neighbours, so parity decides the inside/);
  assert.equal(care_of(info([body("hull")], ["one", "two"])).text, "All surfaces are closed, but read the 2 warnings below.");
  assert.equal(care_of(info([])).level, "fine");
});

test("the file is compared with one byte per cell", () => {
  const { dense, times } = compression(info([]));
  assert.equal(dense, 1e12);
  assert.equal(Math.round(times), 63914);
});

test("sizes make sense for the smallest grids as well", () => {
  const of = (cells: [number, number, number], bytes: number) => size_text({ grid: { cells }, file: { bytes } } as unknown as GridInfo);
  assert.equal(of([10000, 10000, 10000], 15645947), "1.00 TB, 63\u202f914 times as much");
  assert.equal(of([10, 10, 10], 400), "1.00 kB, 2.50 times as much");
  assert.equal(of([1, 1, 1], 1096), "1 B, less than this file");
  assert.deepEqual([levels_text(1), levels_text(4)], ["only the cells themselves", "4, with cells up to 8 times as wide"]);
  assert.deepEqual([1, 2].map((cells) => body_cells(body("a", { cells }))), ["1 cell", "2 cells"]);
});

test("of very many holes only the widest are marked", () => {
  const holes = Array.from({ length: 10000 }, (_, n) => hole(n, n));
  const places = places_found(info([body("sieve", { holes })]));
  assert.equal(places.length, 500);
  assert.match(places[0]!.text, /^hole in sieve: 9\u202f999/);
});
