// Messages: how long they stay; and what is said about files that are no grids.
import assert from "node:assert/strict";
import test from "node:test";
import { drop, hold, release, say, toasts } from "@page/base/messages";
import { advice_for } from "@page/module/advice";
import { is_loopback } from "@page/panels/share_links";

// A clock that stands still until it is told to go on.
let now = 0;
let timers = 0;
const due = new Map<number, { at: number; call: () => void }>();
Object.assign(globalThis, {
  setTimeout: (call: () => void, after: number) => (due.set(++timers, { at: now + after, call }), timers),
  clearTimeout: (timer: number) => due.delete(timer),
});
function wait(milliseconds: number): void {
  now += milliseconds;
  for (const [timer, { at, call }] of [...due]) if (at <= now && due.delete(timer)) call();
}
const texts = () => toasts.value.map(({ text, times }) => `${text} ${times}`);

test("a message goes by itself, later the longer it is; one that comes again is counted and begins anew", () => {
  say("short");
  say("long", { detail: "word ".repeat(40) });
  wait(5000);
  assert.deepEqual(texts(), ["short 1", "long 1"]);
  wait(3000);
  assert.deepEqual(texts(), ["long 1"]);
  wait(6000);
  say("long", { detail: "another" });
  wait(15_000);
  assert.deepEqual(texts(), ["long 2"]);
  wait(15_000);
  assert.deepEqual(texts(), []);
});

test("what is held stays, also when it comes again, and goes once it is released", () => {
  say("a");
  hold("a");
  wait(1e6);
  say("a");
  wait(1e6);
  assert.deepEqual(texts(), ["a 2"]);
  release("a");
  wait(10_000);
  assert.deepEqual(texts(), []);
  say("b");
  hold("b");
  drop("b");
  release("b"); // the pointer leaves what is gone
  say("b");
  wait(10_000);
  assert.deepEqual(texts(), []);
});

test("of many messages the newest are there", () => {
  for (const text of "abcdef") say(text);
  assert.deepEqual(texts(), ["c 1", "d 1", "e 1", "f 1"]);
});

test("surfaces are meshed, grids that the page can't read are served, and of others nothing is known", () => {
  assert.equal(advice_for("a.b c.STL", true)!.command, "teracell mesh 'a.b c.STL' --cells 200 -o 'a.b c.tcell'");
  for (const ending of ["stl", "obj", "ply", "off", "3mf", "gltf", "glb", "step", "stp"]) assert.match(advice_for(`x.${ending}`, true)!.text, /surface.*drop x\.tcell here/);
  assert.match(advice_for("x.stl", false)!.text, /serve x\.tcell/);
  assert.equal(advice_for("x.tcell", false)!.command, "teracell serve x.tcell");
  for (const name of ["x.tcell", "x", ".stl", "x.png"]) assert.equal(advice_for(name, true), null, name);
});

test("loopback is this machine, whatever its spelling", () => {
  for (const name of ["localhost", "a.localhost", "127.0.0.1", "127.1.2.3", "[::1]"]) assert.ok(is_loopback(name), name);
  for (const name of ["", "10.0.0.1", "localhost.example.org", "127.example.org", "grids"]) assert.ok(!is_loopback(name), name);
});
