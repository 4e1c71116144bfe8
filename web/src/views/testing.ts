// `window.teracell`, for tests in a browser and for curious people: what the page shows, without reading pixels.
import type { AxisIndex } from "../base/grid";
import type { Viewer } from "../state/viewer";
import type { Stage } from "./stage";

export interface Exposed {
  readonly viewer: Viewer;
  // Whether all that is in sight is of the finest level that the zoom asks for, of the right slice, and painted.
  idle(): boolean;
  // The same for one view, and whether part of it still shows another slice.
  shown(axis: AxisIndex): { readonly sharp: boolean; readonly stale: boolean };
  // Labels painted at a point of the page in CSS pixels (as a mouse event's clientX and clientY); null: nothing, or outside.
  label_at(axis: AxisIndex, x: number, y: number): readonly number[] | null;
  // Milliseconds from the start of each frame that changed pixels to the start of the next.
  readonly frame_times: number[];
  // What stands on the right in a comparison.
  readonly other?: Exposed;
}

declare global {
  interface Window {
    teracell?: Exposed;
  }
}

function exposed_of(stage: Stage): Exposed {
  return {
    viewer: stage.viewer,
    idle: () => stage.idle(),
    shown: (axis) => ({ sharp: !stage.changing && stage.views[axis].sharp, stale: stage.views[axis].shown.stale }),
    label_at(axis, x, y) {
      const view = stage.views[axis];
      const box = view.cells.getBoundingClientRect();
      const number = view.painted_at(x - box.left, y - box.top);
      return number === null ? null : stage.sets.members(number);
    },
    frame_times: stage.frame_times,
  };
}

export function expose(stage: Stage, right?: Stage): () => void {
  const [left, other] = [exposed_of(stage), right && exposed_of(right)];
  const exposed: Exposed = other ? { ...left, other, idle: () => left.idle() && other.idle() } : left;
  window.teracell = exposed;
  return () => {
    if (window.teracell === exposed) delete window.teracell;
  };
}
