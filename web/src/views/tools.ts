// What dragging draws: a line that measures a distance, or a box for statistics.
import { FRAMES } from "../base/axis";
import type { AxisIndex, Index3 } from "../base/grid";
import type { Box } from "../state/viewer";
import type { Stage } from "./stage";

export interface Drag {
  move(x: number, y: number): void;
  end(drawn: boolean): void; // if it was not drawn, everything is as before
}

// Starts the chosen tool at (x, y), in CSS pixels of the view. A tool draws once: the next drag moves the picture
// again.
export function start_tool(stage: Stage, axis: AxisIndex, x: number, y: number): Drag | null {
  const { tool } = stage.viewer;
  if (tool.value === "look") return null;
  const drag = tool.value === "measure" ? measure(stage, axis, x, y) : box(stage, axis, x, y);
  return {
    move: drag.move,
    end: (drawn) => {
      drag.end(drawn);
      if (drawn) tool.value = "look";
    },
  };
}

function measure(stage: Stage, axis: AxisIndex, x0: number, y0: number): Drag {
  const { viewer } = stage;
  const { u, v } = FRAMES[axis];
  const point = (x: number, y: number) => {
    const camera = stage.views[axis].camera_of(viewer, 1);
    const p: [number, number, number] = [0, 0, 0];
    p[axis] = viewer.axes[axis].centre(viewer.cell.value[axis]);
    p[u] = camera.u_at(x);
    p[v] = camera.v_at(y);
    return p;
  };
  const from = point(x0, y0);
  const before = viewer.measure.value;
  return {
    move: (x, y) => (viewer.measure.value = { axis, from, to: point(x, y) }),
    end: (drawn) => {
      if (!drawn) viewer.measure.value = before;
    },
  };
}

// Across the view the box keeps its extent. A new box goes through the whole grid, until a drag in another view cuts
// it.
function box(stage: Stage, axis: AxisIndex, x0: number, y0: number): Drag {
  const { viewer } = stage;
  const { u, v } = FRAMES[axis];
  const cell = (x: number, y: number) => {
    const camera = stage.views[axis].camera_of(viewer, 1);
    const clamp = (i: number, n: number) => Math.min(Math.max(i, 0), n - 1);
    return [clamp(camera.across.cell_at(camera.u_at(x)), viewer.cells[u]), clamp(camera.up.cell_at(camera.v_at(y)), viewer.cells[v])] as const;
  };
  const [a0, b0] = cell(x0, y0);
  const before: Box = viewer.box.value ?? [0, 0, 0, ...viewer.cells];
  return {
    move: (x, y) => {
      const [a, b] = cell(x, y);
      const low: Index3 = [before[0], before[1], before[2]];
      const high: Index3 = [before[3], before[4], before[5]];
      [low[u], high[u]] = [Math.min(a0, a), Math.max(a0, a) + 1];
      [low[v], high[v]] = [Math.min(b0, b), Math.max(b0, b) + 1];
      stage.draft.value = [...low, ...high];
    },
    end: (drawn) => {
      if (drawn && stage.draft.value) {
        viewer.box.value = stage.draft.value;
        viewer.panel.value = "box";
      }
      stage.draft.value = null;
    },
  };
}
