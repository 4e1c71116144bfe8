// Numbers as the page writes and reads them.
import assert from "node:assert/strict";
import test from "node:test";
import {
  about, bytes_text, coordinate, csv_name, decimals, grouped, milliseconds, noun, number_of, percent, plural, product, prose, significant, sizes, unit_name,
} from "@page/base/format";

// Writes narrow spaces as plain ones, so that people can read them here.
const plain = (text: string) => text.replaceAll("\u202f", " ");

test("thousands are set apart, even in counts that no double holds", () => {
  assert.equal(grouped(7), "7");
  assert.equal(plain(grouped(1000)), "1 000");
  assert.equal(plain(grouped(-1234567)), "−1 234 567");
  assert.equal(plain(grouped("123456789012345678901234567890")), "123 456 789 012 345 678 901 234 567 890");
  assert.equal(plain(grouped(10n ** 18n)), "1 000 000 000 000 000 000");
  assert.equal(plain(grouped("1234.56789")), "1 234.56789");
});

test("a long count has three digits and its power of ten", () => {
  assert.equal(plain(about(999999)), "999 999");
  assert.equal(about(1e12), "10¹²");
  assert.equal(about(1500714712), "1.5 × 10⁹");
  assert.equal(about(114056000n), "1.14 × 10⁸");
});

test("a coordinate shows a tenth of its cell, no more", () => {
  assert.deepEqual([100, 10, 1, 0.5, 0.142315, 0.1, 0.01].map(decimals), [0, 0, 1, 2, 2, 2, 3]);
  assert.equal(coordinate(12.3456, 0.1), "12.35");
  assert.equal(coordinate(-12.3456, 0.1), "−12.35");
  assert.equal(plain(coordinate(123456.7, 1)), "123 456.7");
});

test("nothing is minus zero", () => {
  assert.equal(coordinate(-0.0001, 0.1), "0.00");
  assert.equal(coordinate(-0, 1), "0.0");
});

test("lengths and volumes have significant digits, and powers of ten instead of many zeros", () => {
  assert.equal(significant(0), "0");
  assert.equal(significant(0.047291, 4), "0.04729");
  assert.equal(plain(significant(3902968.7, 6)), "3 902 969");
  assert.equal(significant(4.8843e-5, 4), "4.884 × 10⁻⁵");
  assert.equal(significant(-2.5e20, 3), "−2.50 × 10²⁰");
  assert.equal(significant(999.96, 4), "1\u202f000.0"); // rounded up into the next thousand
});

test("bytes come in decimal units", () => {
  assert.equal(bytes_text(0), "0 B");
  assert.equal(bytes_text(999), "999 B");
  assert.equal(bytes_text(15645947), "15.6 MB");
  assert.equal(bytes_text(1e12), "1.00 TB");
  assert.equal(bytes_text(1.02e15), "1.02 PB");
});

test("a share is 0 or 100 % only when it is", () => {
  assert.deepEqual([0, 1e-9, 0.00003, 0.0123, 0.9023, 0.999999, 1].map(percent), [
    "0 %", "< 0.001 %", "0.003 %", "1.23 %", "90.2 %", "> 99.99 %", "100 %",
  ]);
});

test("times are as fine as they are short", () => {
  assert.deepEqual([0.34, 12.4, 1234, NaN].map(milliseconds), ["0.3 ms", "12 ms", "1.23 s", "–"]);
});

test("words follow their number", () => {
  assert.equal(plural(1, "hole"), "1 hole");
  assert.equal(plural(0, "hole"), "0 holes");
  assert.equal(plural(2, "body", "bodies"), "2 bodies");
  assert.equal(plural("1", "cell"), "1 cell");
  assert.equal(plural(1n, "cell"), "1 cell");
  assert.equal(noun(10n ** 18n, "cell"), "cells");
});

test("units are written as people write them", () => {
  assert.deepEqual(["um", "mm", "in"].map(unit_name), ["µm", "mm", "in"]);
});

test("cells are multiplied exactly", () => {
  assert.equal(product([1000003, 1000003, 1000003]), 1000009000027000027n);
  assert.equal(plain(sizes([10000, 20, 3])), "10 000 × 20 × 3");
});

test("numbers are read as this page writes them, and as people type them", () => {
  for (const n of [0, 7, 5000, 1234567, -1234.5]) assert.equal(number_of(grouped(n)), n);
  const typed = { " 12 ": 12, "1 00": 100, "−3.5": -3.5, "-3,5": -3.5, "0,500": 0.5, "1,234,567": 1234567, "1,234.5": 1234.5, "1e3": 1000 };
  for (const [text, n] of Object.entries(typed)) assert.equal(number_of(text), n, text);
  assert.equal(number_of("5,000"), null); // it may mean five thousand, or five
  assert.equal(number_of("5,000", true), 5000);
  for (const text of ["", " ", "many", "1 2 x", "1,2,3", "1.2.3", "Infinity", "--1"]) assert.equal(number_of(text), null, text);
});

test("names in a CSV file are not taken for formulas, and stand in quotes where they must", () => {
  assert.deepEqual(["steel", "a, b", 'say "so"', "=HYPERLINK(1)", "-1,2"].map(csv_name), [
    "steel",
    '"a, b"',
    '"say ""so"""',
    "'=HYPERLINK(1)",
    '"\'-1,2"',
  ]);
});

test("sentences of the server get true minus signs and thin spaces", () => {
  assert.equal(prose("at (-0.5, 2, -.25): -3 mm"), "at (−0.5, 2, −.25): −3 mm");
  assert.equal(prose("1,234,567 cells in walls of 2-3 cells, a-4 and 12,34"), "1\u202f234\u202f567 cells in walls of 2-3 cells, a-4 and 12,34");
});
