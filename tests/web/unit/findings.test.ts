// Findings are grouped by kind, the worst first, and the verdict says how bad they are.
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Finding, type Findings, bodies_of, groups_of } from "@page/base/findings";
import { verdict } from "@page/panels/finding_words";
import { markers_of } from "@page/state/findings";

const finding = (kind: Finding["kind"], level: Finding["level"], bodies: string[], at: Finding["at"] = null): Finding => ({
  kind, level, bodies, cells: 1, at, box: null, text: `${kind} of ${bodies.join()}`,
});
const found = (findings: Finding[], totals: Findings["totals"] = {}): Findings => ({ findings, totals, walls: [], not_looked_at: [] });

test("groups have the worst level of their findings, and come by it", () => {
  const all = found(
    [finding("thin", "note", ["a"]), finding("cut", "note", ["b"]), finding("thin", "warning", ["b"]), finding("empty", "error", ["c"]), finding("overlap", "note", ["a", "b"])],
    { thin: { findings: 5000, cells: 1 } },
  );
  assert.deepEqual(groups_of(all, "").map((g) => [g.kind, g.level, g.findings.length, g.total]), [
    ["empty", "error", 1, 1], ["thin", "warning", 2, 5000], ["cut", "note", 1, 1], ["overlap", "note", 1, 1],
  ]);
  assert.deepEqual(groups_of(all, "b").map((g) => [g.kind, g.total]), [["thin", 1], ["cut", 1], ["overlap", 1]]);
  assert.deepEqual(bodies_of(all), ["a", "b", "c"]);
});

test("the verdict is about the worst, and says when there is more than is listed", () => {
  assert.deepEqual(verdict(found([])), { level: "fine", text: "Nothing was found." });
  assert.deepEqual(verdict(found([finding("cut", "note", ["a"])])), { level: "fine", text: "Nothing to worry about. 1 note." });
  assert.deepEqual(verdict(found([finding("thin", "warning", ["a"]), finding("thin", "warning", ["a"])], { thin: { findings: 2000, cells: 1 } })), {
    level: "look", text: "Probably fine, but look at 2 warnings, 2\u202f000 findings in all.",
  });
  assert.equal(verdict(found([finding("empty", "error", ["a"])])).level, "bad");
});

test("what has a place can be marked, but not more than can be seen", () => {
  const all = found(Array.from({ length: 100 }, (_, i) => finding("thin", "note", ["a"], i % 2 ? [i, 0, 0] : null)));
  assert.equal(markers_of(all).length, 50);
  assert.deepEqual(markers_of(all)[0], { at: [1, 0, 0], text: "thin of a" });
});
