// What dragging draws: a line that measures a distance, or a box for statistics.
import { FRAMES } from "../base/axis";
import type { AxisIndex, Index3 } from "../base/grid";
import { next_id, put_measure, unfinished } from "../state/measures";
import type { Box, Measure } from "../state/viewer";
import { type Handle, dragged, handle_at, handles_of } from "./drawing/box_handles";
import { snapped } from "./snap";
import type { Stage } from "./stage";

export interface Drag {
  move(x: number, y: number, free: boolean): void; // free: nothing snaps
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
  const point = (x: number, y: number) => stage.views[axis].under(viewer, x, y).point;
  const before = { measures: viewer.measures.value, chosen: viewer.chosen.value };
  const id = unfinished(viewer)?.id ?? next_id(before.measures); // a line that has no end yet makes way
  let [from, to] = [point(x0, y0), point(x0, y0)];
  let ends = new AbortController(); // of the request for the end that is being drawn
  const abort = new AbortController();
  let last: Measure | null = null; // the line as it was drawn here last
  const draw = () => put_measure(viewer, (last = { id, name: "", axis, from, to }));
  const snap = (where: [number, number, number], signal: AbortSignal, take: (p: [number, number, number]) => void) => {
    void snapped(viewer, axis, where, signal).then(
      (p) => {
        if (signal.aborted || viewer.measure.value !== last) return; // it is gone, or there is another line
        take(p);
        draw();
      },
      () => {}, // it stays where it is
    );
  };
  let begun = false;
  return {
    move: (x, y, free) => {
      if (!begun && !free) snap(from, abort.signal, (p) => (from = p));
      begun = true;
      ends.abort();
      ends = new AbortController();
      to = point(x, y);
      draw();
      if (!free) snap(to, ends.signal, (p) => (to = p));
    },
    end: (drawn) => {
      if (drawn) {
        viewer.thickness.value = null;
        viewer.measuring.value = null;
        viewer.panel.value = "box";
        return;
      }
      abort.abort();
      ends.abort();
      viewer.measures.value = before.measures;
      viewer.chosen.value = before.chosen;
    },
  };
}

// Drags the handle of the box that lies at (x, y), if there is one.
export function start_handle(stage: Stage, axis: AxisIndex, x: number, y: number): Drag | null {
  const { viewer } = stage;
  const box = viewer.box.value;
  const handle = handle_under(stage, axis, x, y);
  if (!box || !handle) return null;
  const camera = stage.views[axis].camera_of(viewer, 1);
  const from = [camera.u_at(x), camera.v_at(y)] as const;
  return {
    move: (to_x, to_y) => {
      stage.draft.value = dragged(viewer.axes, FRAMES[axis], box, handle, from, [camera.u_at(to_x), camera.v_at(to_y)]);
    },
    end: (drawn) => {
      if (drawn && stage.draft.value) viewer.box.value = stage.draft.value;
      stage.draft.value = null;
    },
  };
}

export function handle_under(stage: Stage, axis: AxisIndex, x: number, y: number): Handle | null {
  const { viewer } = stage;
  const box = viewer.box.value;
  if (!box || viewer.zoom.value === 0) return null;
  return handle_at(handles_of(stage.views[axis].camera_of(viewer, 1), FRAMES[axis], box), x, y);
}

// Across the view the box keeps its extent. A new box goes through the whole grid, until a drag in another view cuts
// it.
function box(stage: Stage, axis: AxisIndex, x0: number, y0: number): Drag {
  const { viewer } = stage;
  const { u, v } = FRAMES[axis];
  const cell = (x: number, y: number) => {
    const at = stage.views[axis].under(viewer, x, y).cell;
    return [viewer.axes[u].clamp(at[u]), viewer.axes[v].clamp(at[v])] as const;
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
