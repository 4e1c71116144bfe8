// What keys and buttons do to the views.
import { batch } from "@preact/signals";
import { FRAMES } from "../base/axis";
import type { AxisIndex, Column, Index3 } from "../base/grid";
import { say, words_of } from "../base/messages";
import { get_json } from "../server/api";
import { SLICE_NORMALS, angles_of, normal_of, turned } from "../oblique/frame";
import { next_id, put_measure, remove_measure, unfinished } from "../state/measures";
import type { ViewName, Viewer } from "../state/viewer";
import { PLAIN_CELL } from "../state/zoom";

// Shows one view alone, or all four again.
export function toggle_layout(viewer: Viewer, view: ViewName): void {
  if (viewer.compared) return; // it has no other views
  viewer.layout.value = viewer.layout.value === "four" ? view : "four";
}

export function toggle_sweep(viewer: Viewer, axis: AxisIndex): void {
  viewer.sweeping.value = viewer.sweeping.value === axis ? null : axis;
}

// Shows the oblique view in place of a slice view, or that again. Its plane is the one that cuts bodies in three dimensions; the first time it is tilted, so that
// it shows what the slice does not.
export function toggle_oblique(viewer: Viewer, axis: AxisIndex): void {
  if (viewer.compared) return;
  batch(() => {
    const on = viewer.oblique.value !== axis;
    if (on) viewer.plane_normal.value ??= [...normal_of(turned(angles_of(SLICE_NORMALS[axis]), 30, axis === 2 ? -30 : 30))];
    viewer.oblique.value = on ? axis : null;
  });
}

// Shows the whole grid in all views.
export function fit(viewer: Viewer): void {
  batch(() => {
    viewer.centre.value = viewer.middle();
    viewer.zoom.value = 0;
  });
}

// Shows single cells: those around the crosshair.
export function show_cells(viewer: Viewer): void {
  const { cell, zoom } = viewer;
  const smallest = Math.min(...viewer.axes.map((axis, d) => axis.width(cell.value[d]!)));
  batch(() => {
    viewer.go_to_cell(cell.value);
    zoom.value = Math.max(zoom.value, PLAIN_CELL / smallest);
  });
}

// A line that has no end yet goes with it.
function put_tool_away(viewer: Viewer): void {
  const measure = unfinished(viewer);
  if (measure) remove_measure(viewer, measure.id);
  viewer.tool.value = "look";
  viewer.measuring.value = null;
}

// Takes one step back: puts the tool away, or else shows all again, lets go of the chosen line, or removes the box or the pin.
export function escape(viewer: Viewer): void {
  batch(() => {
    viewer.sweeping.value = null;
    const measure = viewer.measure.value;
    if (viewer.tool.value !== "look") {
      put_tool_away(viewer);
      return;
    }
    if (viewer.isolated.value) viewer.isolated.value = null;
    else if (measure || viewer.thickness.value) {
      viewer.chosen.value = null;
      viewer.thickness.value = null;
    }
    else if (viewer.box.value) viewer.box.value = null;
    else viewer.pinned.value = null;
  });
}

export function remove_chosen(viewer: Viewer): void {
  if (viewer.measure.value) remove_measure(viewer, viewer.measure.value.id);
}

// Moves the crosshair within the plane of a slice, by whole cells of the level that is shown. All views follow when it
// would leave this one. A line that is measured by keys follows as well.
export function step_crosshair(viewer: Viewer, axis: AxisIndex, du: number, dv: number): void {
  const { u, v } = FRAMES[axis];
  const by = 2 ** viewer.level[axis].value;
  const cell: Index3 = [...viewer.cell.value];
  cell[u] += du * by;
  cell[v] += dv * by;
  batch(() => {
    viewer.set_cell(cell);
    const size = viewer.views.find((view) => view.axis === axis);
    const away = (d: AxisIndex) => Math.abs(viewer.axes[d].centre(viewer.cell.value[d]) - viewer.centre.value[d]) * viewer.zoom.value;
    if (size && (away(u) > size.width / 2 || away(v) > size.height / 2)) viewer.go_to_cell(viewer.cell.value);
    const line = unfinished(viewer);
    if (line?.axis === axis) put_measure(viewer, { ...line, to: viewer.centre_of(viewer.cell.value) });
  });
}

// Begins a line at the crosshair while the tool measures; the second time it ends there, and the tool is put away.
export function mark_measure(viewer: Viewer, axis: AxisIndex): void {
  if (viewer.tool.value !== "measure") return;
  batch(() => {
    const begun = unfinished(viewer);
    if (begun?.axis === axis) {
      viewer.measuring.value = null;
      viewer.tool.value = "look";
    } else {
      const here = viewer.centre_of(viewer.cell.value);
      const id = begun?.id ?? next_id(viewer.measures.value);
      put_measure(viewer, { id, name: "", axis, from: here, to: here });
      viewer.measuring.value = id;
    }
  });
}

// Measures how thick the material of a cell is: along the three axes, and in the slice where that is least.
export function measure_thickness(viewer: Viewer, axis: AxisIndex, cell: Index3): void {
  batch(() => {
    viewer.set_cell(cell);
    viewer.thickness.value = cell;
    viewer.chosen.value = null;
    viewer.panel.value = "box";
  });
  const { u, v } = FRAMES[axis];
  const run_along = async (d: AxisIndex) => {
    const { runs } = await get_json<Column>(viewer.address.column(d, cell[FRAMES[d].u], cell[FRAMES[d].v]));
    return { d, run: runs.find(({ from, to }) => from <= cell[d] && cell[d] < to)! };
  };
  void Promise.all([run_along(u), run_along(v)]).then(
    (found) => {
      if (viewer.thickness.peek() !== cell) return; // another one is measured
      // Planes are those of the axis: of a grid that is shown in another unit, the answer has the file's own.
      const ends = found.map(({ d, run }) => ({ d, min: viewer.axes[d].plane(run.from), max: viewer.axes[d].plane(run.to) }));
      const { d, min, max } = ends.reduce((a, b) => (b.max - b.min < a.max - a.min ? b : a));
      const end = (x: number) => viewer.axes.map((own, e) => (e === d ? x : own.centre(cell[e]!))) as [number, number, number];
      put_measure(viewer, { id: next_id(viewer.measures.value), name: "", axis, from: end(min), to: end(max) });
    },
    (error: unknown) => say(`The thickness can't be measured: ${words_of(error)}.`),
  );
}

// Takes a tool for the next drag, or puts it away if it is taken.
export function choose_tool(viewer: Viewer, tool: "measure" | "box"): void {
  if (viewer.compared && tool === "box") return; // there are no statistics of boxes
  batch(() => {
    const taken = viewer.tool.value === tool;
    put_tool_away(viewer);
    if (!taken) viewer.tool.value = tool;
  });
}
