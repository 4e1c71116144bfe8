// What to say about a place outside the grid, of which the page shows the nearest one inside; null for a place inside. The
// upper end of an axis counts as inside.
import type { Axis } from "../base/axis";
import { coordinate, grouped } from "../base/format";
import { AXES, AXIS_NAMES, type AxisIndex } from "../base/grid";

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

export function outside_cell(axes: Axes, cell: readonly number[]): string | null {
  if (AXES.every((d) => cell[d]! >= 0 && cell[d]! < axes[d].cells)) return null;
  const last = AXES.map((d) => grouped(axes[d].cells - 1)).join(", ");
  return `Cell ${cell.map((i) => grouped(i)).join(", ")} is outside the grid, whose last cell is ${last}: the nearest one is shown.`;
}
