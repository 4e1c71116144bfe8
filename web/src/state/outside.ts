// What to say about a place outside the grid, of which the page shows the nearest one inside; null for a place inside. The
// upper end of an axis counts as inside.
import type { Axis } from "../base/axis";
import { coordinate, grouped, unit_name } from "../base/format";
import { AXES, AXIS_NAMES, type AxisIndex } from "../base/grid";
import { drop, say } from "../base/messages";
import type { Viewer } from "./viewer";

// Says it of where the crosshair has been put, until it is moved on.
export function say_of_place(viewer: Viewer, text: string): void {
  say(text);
  const here = viewer.cell.peek();
  const stop = viewer.cell.subscribe((cell) => {
    if (cell === here) return;
    drop(text);
    stop();
  });
}

type Axes = readonly [Axis, Axis, Axis];

export function outside_slice(axes: Axes, d: AxisIndex, index: number): string | null {
  const last = axes[d].cells - 1;
  if (index >= 0 && index <= last) return null;
  return `Slice ${grouped(index)} across ${AXIS_NAMES[d]} is outside the grid, which has slices 0 to ${grouped(last)}: the nearest one is shown.`;
}

export function outside_coordinate(axes: Axes, d: AxisIndex, x: number, units: string): string | null {
  const axis = axes[d];
  if (x >= axis.min && x <= axis.max) return null;
  const text = (value: number) => coordinate(value, axis.finest);
  const range = `from ${text(axis.min)} to ${text(axis.max)} ${units}`;
  return `${AXIS_NAMES[d]} = ${text(x)} ${units} is outside the grid, which goes ${range}: the nearest slice is shown.`;
}

// A point that somebody names.
export function outside_place(axes: Axes, point: readonly number[], units: string): string | null {
  const d = AXES.find((a) => point[a]! < axes[a].min || point[a]! > axes[a].max);
  if (d === undefined) return null;
  const text = (value: number) => coordinate(value, axes[d].finest);
  return `${AXIS_NAMES[d]} = ${text(point[d]!)} ${unit_name(units)} is outside the grid, which goes from ${text(axes[d].min)} to ${text(axes[d].max)} ${unit_name(units)}: the nearest place is shown.`;
}

// A point that is looked at.
export function outside_point(axes: Axes, point: readonly number[], units: string): string | null {
  const d = AXES.find((a) => point[a]! < axes[a].min || point[a]! > axes[a].max);
  if (d === undefined) return null;
  const text = coordinate(point[d]!, axes[d].finest);
  return `The link looks at ${AXIS_NAMES[d]} = ${text} ${units}, which is outside the grid: the nearest place is shown.`;
}

// Cells of a box, half open.
export function outside_box(axes: Axes, box: readonly number[]): string | null {
  if (AXES.every((d) => box[d]! >= 0 && box[d + 3]! <= axes[d].cells && box[d]! < box[d + 3]!)) return null;
  const cells = AXES.map((d) => grouped(axes[d].cells)).join(" × ");
  return `The link's box, ${box.map((i) => grouped(i)).join(", ")}, does not lie in the grid of ${cells} cells: it is left out.`;
}

export function outside_cell(axes: Axes, cell: readonly number[]): string | null {
  if (AXES.every((d) => cell[d]! >= 0 && cell[d]! < axes[d].cells)) return null;
  const last = AXES.map((d) => grouped(axes[d].cells - 1)).join(", ");
  return `Cell ${cell.map((i) => grouped(i)).join(", ")} is outside the grid, whose last cell is ${last}: the nearest one is shown.`;
}

// How far from the grid, in lengths of its longest side, a camera or an end of a measured line makes sense.
const FARTHEST = 1e6;

// Of a camera or a measured line that a link names: null if it is within reach, and else what to say about it.
export function beyond_reach(axes: Axes, what: string, coordinates: readonly number[]): string | null {
  const most = FARTHEST * Math.max(...AXES.flatMap((d) => [axes[d].max - axes[d].min, Math.abs(axes[d].min), Math.abs(axes[d].max)]));
  return coordinates.every((x) => Math.abs(x) <= most) ? null : `${what} of the link lies far outside the grid: it is left out.`;
}
