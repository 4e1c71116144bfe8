// Findings are grouped by kind, the worst first, and the verdict says how bad they are.
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Finding, type Findings, bodies_of, groups_of, overlaps_reported } from "@page/base/findings";
import { not_checked, verdict } from "@page/panels/finding_words";
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

test("the verdict names the kinds of the worst, and says when there is more than is listed", () => {
  assert.deepEqual(verdict(found([])), { level: "fine", text: "Nothing was found." });
  assert.deepEqual(verdict(found([finding("cut", "note", ["a"])])), { level: "fine", text: "No warnings, 1 note." });
  assert.deepEqual(verdict(found([finding("thin", "warning", ["a"]), finding("cap", "warning", ["a"]), finding("thin", "warning", ["b"])], { thin: { findings: 2000, cells: 1 } })), {
    level: "look", text: "3 warnings: thin walls (2), holes (1). 2\u202f000 findings in all.",
  });
  assert.deepEqual(verdict(found([finding("empty", "error", ["a"]), finding("thin", "warning", ["a"])])), {
    level: "bad", text: "1 error: bodies without cells (1), and 1 warning.",
  });
});

test("nothing is called fine as long as something was not looked at", () => {
  const blind = (findings: Finding[]): Findings => ({ ...found(findings), not_looked_at: ["Overlaps by pair."] });
  assert.deepEqual(verdict(blind([])), { level: "look", text: "Nothing was found. Not everything was looked at." });
  assert.deepEqual(verdict(blind([finding("cut", "note", ["a"])])), { level: "look", text: "No warnings, 1 note. Not everything was looked at." });
});

test("what has a place can be marked, the worst of each kind first, but not more than leaves room to see it", () => {
  const all = found([
    ...Array.from({ length: 100 }, (_, i) => finding("thin", "note", ["a"], i % 2 ? [i, 0, 0] : null)),
    finding("cap", "warning", ["b"], [7, 7, 7]),
  ]);
  assert.equal(markers_of(all).length, 24);
  assert.deepEqual(markers_of(all)[0], { at: [7, 7, 7], text: "cap of b", name: "hole · b" });
  assert.deepEqual(markers_of(all)[1], { at: [1, 0, 0], text: "thin of a", name: "thin wall · a" });
  assert.deepEqual(markers_of(found([])), []);
  const last = all.findings[99]!;
  assert.deepEqual(markers_of(all, { body: "", kind: "thin", finding: last })[0]!.at, [99, 0, 0]);
  assert.equal(markers_of(all, { body: "", kind: "cap", finding: null }).length, 1);
  assert.equal(markers_of(all, { body: "b", kind: null, finding: null }).length, 1);
});

test("a grid that nobody has looked through is not called fine", () => {
  assert.deepEqual(not_checked({ level: "fine", text: "All is closed." }), { level: "look", text: "Not checked yet. All is closed." });
  assert.deepEqual(not_checked({ level: "bad", text: "A hole." }), { level: "bad", text: "A hole." });
});

test("overlaps that the mesher has found are findings of a grid that nobody has checked", () => {
  const report = { bodies: [], crossings: 0, warnings: [], inputs: [] };
  const pair = { bodies: ["a", "b"] as [string, string], cells: 1, box: [0, 0, 0, 1, 1, 1] as Finding["box"] & object, at: [0.5, 0.5, 0.5] as [number, number, number] };
  const group = overlaps_reported({ ...report, overlaps: { pairs: 7, list: [{ ...pair, cells: 2000, owner: "b" }, { ...pair, owner: null }] } })!;
  assert.deepEqual([group.kind, group.level, group.total], ["overlap", "note", 7]);
  assert.match(group.findings[0]!.text, /^'a' and 'b' overlap in 2.000 cells, which 'b' owns\.$/);
  assert.equal(group.findings[1]!.text, "'a' and 'b' overlap in 1 cell, which a third body owns in part.");
  assert.equal(overlaps_reported(report), null);
  assert.equal(overlaps_reported({ ...report, overlaps: { pairs: 0, list: [] } }), null);
});
