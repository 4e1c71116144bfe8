// Colours against the ground that they are drawn on.
import assert from "node:assert/strict";
import test from "node:test";
import { contrast, needs_other_ground } from "@page/base/contrast";

test("contrast is that of WCAG", () => {
  assert.equal(contrast([0, 0, 0], [255, 255, 255]), 21);
  assert.equal(contrast([90, 10, 200], [90, 10, 200]), 1);
  // An example of WCAG's own tools: #777777 on white.
  assert.equal(contrast([0x77, 0x77, 0x77], [255, 255, 255]).toFixed(2), "4.48");
});

test("black needs another ground in the dark theme, white in the light one, and nothing else does", () => {
  assert.equal(needs_other_ground("dark", [[0x22, 0x22, 0x22], [200, 0, 0]]), true);
  assert.equal(needs_other_ground("light", [[0x22, 0x22, 0x22], [200, 0, 0]]), false);
  assert.equal(needs_other_ground("light", [[250, 250, 250]]), true);
  assert.equal(needs_other_ground("dark", [[250, 250, 250], [0x5a, 0x62, 0x70]]), false);
  assert.equal(needs_other_ground("dark", []), false);
});

test("where both grounds swallow a material, the usual one stays", () => {
  assert.equal(needs_other_ground("dark", [[10, 10, 10], [74, 84, 98]]), false);
});
