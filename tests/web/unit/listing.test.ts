// Which grids are listed on the start page, and in which order.
import assert from "node:assert/strict";
import test from "node:test";
import type { Index3 } from "@page/base/grid";
import { type Order, listed } from "@page/start/listing";

const grid = (name: string, cells: Index3, bytes: number, modified: number | null) => ({ name, cells, bytes, modified });
const grids = [grid("wing 10", [10, 10, 10], 5, 30), grid("Wing 9", [20, 10, 10], 9, 10), grid("antenna", [10, 10, 10], 7, null)];
const names = (text: string, order: Order) => listed(grids, text, order).map(({ name }) => name).join();

test("a search finds parts of names, in whatever case", () => {
  assert.equal(names("WING", "name"), "Wing 9,wing 10");
  assert.equal(names(" ten ", "name"), "antenna");
  assert.equal(names("x", "name"), "");
});

test("grids are ordered by name, by age, by cells and by size", () => {
  assert.equal(names("", "name"), "antenna,Wing 9,wing 10");
  assert.equal(names("", "newest"), "wing 10,Wing 9,antenna");
  assert.equal(names("", "cells"), "Wing 9,antenna,wing 10");
  assert.equal(names("", "bytes"), "Wing 9,antenna,wing 10");
});
