// A sweep on a clock that the test sets.
import assert from "node:assert/strict";
import test, { mock } from "node:test";
import { signal } from "@preact/signals";
import type { AxisIndex } from "@page/base/grid";
import type { Stage } from "@page/views/stage";
import { attach_sweep } from "@page/views/sweep";

test("the next slice comes after a tenth of a second, or as soon as late tiles have come, but after a second in any case", () => {
  let now = 5000;
  let timer: { at: number; run: () => void } | null = null;
  mock.method(performance, "now", () => now);
  mock.method(globalThis, "clearTimeout", () => (timer = null));
  Object.assign(globalThis, { window: { setTimeout: (run: () => void, wait: number) => (timer = { at: now + wait, run }) } });
  const waiting = signal(false);
  const sweeping = signal<AxisIndex | null>(null);
  const cell = signal([0, 0, 0]);
  const viewer = { sweeping, cell, cells: [1, 1, 4], set_slice: (_: AxisIndex, to: number) => (cell.value = [0, 0, to]) };
  const stage = { viewer, waiting: [signal(false), signal(false), waiting], views: [0, 1, 2].map(() => ({ level: 0 })) };
  const stop = attach_sweep(stage as unknown as Stage);
  const after = (milliseconds: number) => {
    for (const end = now + milliseconds; now < end; ++now)
      if (timer && timer.at <= now) {
        const { run } = timer;
        timer = null;
        run();
      }
    return cell.value[2];
  };
  assert.equal(after(1000), 0);
  sweeping.value = 2;
  assert.equal(after(10), 1);
  assert.equal(after(80), 1);
  assert.equal(after(20), 2);
  waiting.value = true;
  assert.equal(after(400), 2);
  waiting.value = false;
  assert.equal(after(10), 3);
  waiting.value = true;
  assert.equal(after(950), 3);
  assert.equal(after(60), 0, "after the last slice comes the first one");
  sweeping.value = null;
  assert.equal(after(3000), 0);
  stop();
  assert.equal(timer, null);
  mock.restoreAll();
});
