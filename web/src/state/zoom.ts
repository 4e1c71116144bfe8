// How large the views show the grid: CSS pixels per unit of length.
import { type Axis, FRAMES } from "../base/axis";
import type { AxisIndex } from "../base/grid";

const MARGIN = 44; // CSS pixels around a grid that fits, for the title and the rulers
const LARGEST_CELL = 160; // CSS pixels
export const PLAIN_CELL = 24; // CSS pixels from which on single cells are seen as such, with lines between them
export const ZOOM_STEP = 2; // of a key or a button: one level of the pyramid

export interface ViewSize {
  readonly axis: AxisIndex;
  readonly width: number; // CSS pixels
  readonly height: number;
}
export type Range = Pick<Axis, "min" | "max">;

// The zoom at which the grid, or a box with these ends, fits into all views of these sizes.
export function fitting_zoom(ranges: readonly [Range, Range, Range], views: readonly ViewSize[]): number {
  const zooms = views.flatMap(({ axis, width, height }) => {
    const frame = FRAMES[axis];
    const extent = ({ min, max }: Range) => max - min;
    const fill = (size: number) => Math.max(size - 2 * MARGIN, size / 2);
    return [fill(width) / extent(ranges[frame.u]), fill(height) / extent(ranges[frame.v])];
  });
  return Math.min(...zooms);
}

// Keeps a zoom within its limits: from a grid a tenth as large as the view to cells as large as a thumb, of which the
// thinnest is `finest` wide.
export function clamped_zoom(zoom: number, finest: number, fitting: number): number {
  return Math.min(Math.max(zoom, fitting / 10), Math.max(LARGEST_CELL / finest, fitting));
}
