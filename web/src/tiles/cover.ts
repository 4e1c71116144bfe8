// Which tiles a view needs: those of the finest level whose cells are at least 0.7 device pixels wide and high. The
// views take two samples per pixel along each axis, so at this size no cell is left out, not even a sheet one cell
// thick. Cells of finer levels would be left out, and their tiles cost more. It follows that a cell is at most 1.4
// pixels large, unless it is of level 0.
//
// The tiles are found from the top of the pyramid: a tile is split into four as long as the cells of the four are large
// enough. On graded axes the levels differ from tile to tile, finer where cells are large and coarser where they are
// small. No single level for the whole view could do that.
import { type Axis, FRAMES } from "../base/axis";
import type { AxisIndex } from "../base/grid";
import { type Extent, type Place, TILE, cells_of_level } from "./place";

export interface Sight {
  readonly axis: AxisIndex;
  readonly slice: number; // a cell of level 0
  readonly axes: readonly [Axis, Axis, Axis];
  readonly levels: number;
  readonly scale: number; // device pixels per unit of length
  readonly seen: Extent; // cells in the view, half open; empty when the grid is out of sight
}

export const SMALLEST = Math.SQRT1_2; // device pixels

// The mean size in pixels of a level's cells in [from, to). It is infinite when the axis has a single cell on that
// level, because no coarser level would make it larger.
function cell_pixels(axis: Axis, from: number, to: number, level: number, scale: number): number {
  if (cells_of_level(axis.cells, level) === 1) return Number.POSITIVE_INFINITY;
  return ((axis.plane(to) - axis.plane(from)) * scale) / Math.ceil((to - from) / 2 ** level);
}

export function cover(sight: Sight): Place[] {
  const frame = FRAMES[sight.axis];
  const [across, up] = [sight.axes[frame.u], sight.axes[frame.v]];
  const { seen } = sight;
  const places: Place[] = [];
  const split = (level: number, column: number, row: number): void => {
    const size = TILE * 2 ** level;
    const [u0, v0] = [column * size, row * size];
    const [u1, v1] = [Math.min(u0 + size, across.cells), Math.min(v0 + size, up.cells)];
    if (u0 >= seen.u1 || u1 <= seen.u0 || v0 >= seen.v1 || v1 <= seen.v0) return;
    const fine = level - 1;
    if (level > 0 && cell_pixels(across, u0, u1, fine, sight.scale) >= SMALLEST && cell_pixels(up, v0, v1, fine, sight.scale) >= SMALLEST) {
      for (const r of [2 * row, 2 * row + 1]) for (const c of [2 * column, 2 * column + 1]) split(fine, c, r);
    } else places.push({ axis: sight.axis, index: sight.slice >> level, level, column, row });
  };
  if (seen.u0 < seen.u1 && seen.v0 < seen.v1) split(sight.levels - 1, 0, 0);
  return places;
}
