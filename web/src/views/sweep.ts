// Plays the slices of a view. Every tenth of a second comes a slice that looks different, unless tiles take longer to
// come. After the last slice comes the first one, until somebody stops it.
import { effect } from "@preact/signals";
import type { Stage } from "./stage";

const EVERY = 100; // milliseconds
const LONGEST = 1000; // milliseconds for which a slice is waited for
const LOOK = 30; // milliseconds until it is looked again whether the slice is there

export function attach_sweep(stage: Stage): () => void {
  const { viewer } = stage;
  let timer = 0;
  const stop = effect(() => {
    clearTimeout(timer);
    const axis = viewer.sweeping.value;
    if (axis === null) return;
    const view = stage.views[axis];
    let waited = 0;
    const step = () => {
      if (!view.sharp && waited < LONGEST) {
        waited += LOOK;
        timer = window.setTimeout(step, LOOK);
        return;
      }
      waited = 0;
      const slab = 2 ** view.level;
      const next = (Math.floor(viewer.cell.peek()[axis] / slab) + 1) * slab + Math.floor(slab / 2);
      viewer.set_slice(axis, next < viewer.cells[axis] ? next : Math.min(Math.floor(slab / 2), viewer.cells[axis] - 1));
      timer = window.setTimeout(step, EVERY);
    };
    timer = window.setTimeout(step, EVERY);
  });
  return () => {
    clearTimeout(timer);
    stop();
  };
}
