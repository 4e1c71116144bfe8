// Plays the slices of a view. Every tenth of a second comes a slice that looks different, unless its tiles take longer to
// come. The first slice follows the last one, until somebody stops it.
import { effect, signal } from "@preact/signals";
import type { AxisIndex } from "../base/grid";
import type { Stage } from "./stage";

const EVERY = 100; // milliseconds
const LONGEST = 1000; // milliseconds after which the next slice comes even if tiles are missing

export function attach_sweep(stage: Stage): () => void {
  const { viewer } = stage;
  const came = signal(-Infinity); // when the slice came, as performance.now()
  let timer = 0;
  const step = (axis: AxisIndex) => {
    const slab = 2 ** stage.views[axis].level;
    const next = (Math.floor(viewer.cell.peek()[axis] / slab) + 1) * slab + Math.floor(slab / 2);
    viewer.set_slice(axis, next < viewer.cells[axis] ? next : Math.min(Math.floor(slab / 2), viewer.cells[axis] - 1));
    came.value = performance.now();
  };
  const stop = effect(() => {
    clearTimeout(timer);
    const axis = viewer.sweeping.value;
    if (axis === null) return;
    const due = came.value + (stage.waiting[axis].value ? LONGEST : EVERY);
    timer = window.setTimeout(() => step(axis), Math.max(0, due - performance.now()));
  });
  return () => {
    clearTimeout(timer);
    stop();
  };
}
