// Which tiles are asked for first.
import assert from "node:assert/strict";
import test from "node:test";
import type { Index3 } from "@page/base/grid";
import { type Place, place_name } from "@page/tiles/place";
import { type ViewNeeds, wants_of } from "@page/tiles/wants";

const cells: Index3 = [10_000, 10_000, 10_000];
const levels = 15;
const place = (axis: 0 | 1 | 2, column: number, level = 2, index = 100): Place => ({ axis, index, level, column, row: 0 });
const view = (more: Partial<ViewNeeds> = {}): ViewNeeds => ({
  places: [],
  missing: [],
  blank: [],
  slice: 401,
  stride: 0,
  first: false,
  focus: [0, 0],
  ...more,
});
const names = (views: ViewNeeds[], ahead: boolean) =>
  wants_of(views, levels, cells)
    .filter((want) => want.ahead === ahead)
    .map((want) => place_name(want.place));

test("tiles in sight are wanted nearest first, in the view in use before the others, and each only once", () => {
  const missing = [place(2, 0), place(2, 1), place(2, 2)];
  const other = view({ missing: [place(0, 4)], places: [place(0, 4)] });
  const used = view({ missing, places: missing, first: true, focus: [2.5 * 512 * 4, 0] });
  assert.deepEqual(names([other, used], false), ["2/100/2/2_0", "2/100/2/1_0", "2/100/2/0_0", "0/100/2/4_0"]);
});

test("where much is blank, a coarse tile comes first, for all views", () => {
  const missing = Array.from({ length: 4 }, (_, column) => place(2, column));
  const wanted = names([view({ missing: [place(0, 0)], blank: [place(0, 0)] }), view({ missing, blank: missing, first: true })], false);
  assert.equal(wanted[0], "2/12/5/0_0");
  assert.equal(wanted[1], "2/100/2/0_0");
  assert.equal(wanted.length, 6);
});

test("then come the next slices in the direction in which slices moved, and one in the other direction", () => {
  const places = [place(2, 0)];
  assert.deepEqual(names([view({ places, first: true, stride: 1 })], true), [
    "2/101/2/0_0", "2/102/2/0_0", "2/103/2/0_0", "2/104/2/0_0", "2/99/2/0_0",
  ]);
  assert.deepEqual(names([view({ places, first: true, stride: -10 })], true), [
    "2/97/2/0_0", "2/95/2/0_0", "2/92/2/0_0", "2/90/2/0_0", "2/102/2/0_0",
  ]);
  assert.deepEqual(names([view({ places })], true), ["2/101/2/0_0", "2/99/2/0_0"]);
});

test("nothing beyond the grid is asked for, and only a few tiles ahead", () => {
  const last = [{ ...place(2, 0), index: 2499 }];
  assert.deepEqual(names([view({ places: last, slice: 9999, first: true })], true), ["2/2498/2/0_0"]);
  const many = Array.from({ length: 30 }, (_, column) => place(2, column));
  assert.equal(names([view({ places: many, first: true })], true).length, 40);
});
