// Lists of numbers in addresses.
import assert from "node:assert/strict";
import test from "node:test";
import { numbers_in, ranges } from "@page/base/ranges";
import { random_of, whole } from "./random";

test("neighbours are written as a range", () => {
  assert.equal(ranges([]), "");
  assert.equal(ranges([3]), "3");
  assert.equal(ranges([1, 2, 3, 5, 7, 8]), "1-3,5,7-8");
});

test("what is written is read back", () => {
  const random = random_of(7);
  for (let i = 0; i < 200; ++i) {
    const list = Array.from({ length: 60 }, (_, n) => n).filter(() => whole(random, 0, 2) > 0);
    assert.deepEqual(numbers_in(ranges(list), 60), list);
  }
});

test("nonsense and numbers that are too large are left out", () => {
  assert.deepEqual(numbers_in("", 9), []);
  assert.deepEqual(numbers_in("x,-1,1-,2,3-1,1.5,7-99999999,9,1e3", 9), [2, 7, 8]);
});
