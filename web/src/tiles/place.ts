// The place of a tile: 512 x 512 cells of one level in one slice. Columns and rows are counted from u = 0 and v = 0.
// The slice is counted in cells of the level as well, so that 2^level slices share their coarse tiles. A grid has fewer
// than 2^31 cells along each axis.
import { FRAMES } from "../base/axis";
import type { AxisIndex, Index3 } from "../base/grid";

export const TILE = 512;

export interface Place {
  readonly axis: AxisIndex;
  readonly index: number;
  readonly level: number;
  readonly column: number;
  readonly row: number;
}

export const place_name = (p: Place): string => `${p.axis}/${p.index}/${p.level}/${p.column}_${p.row}`;

export const cells_of_level = (cells: number, level: number): number => Math.ceil(cells / 2 ** level);

// How many cells of its level a tile has along u and v. Tiles at the grid's edges are cut.
export function tile_size(place: Place, cells: Index3): [number, number] {
  const { u, v } = FRAMES[place.axis];
  const along = (n: number, at: number) => Math.min(TILE, cells_of_level(n, place.level) - at * TILE);
  return [along(cells[u], place.column), along(cells[v], place.row)];
}

// Cells of level 0, half open.
export interface Extent {
  u0: number;
  u1: number;
  v0: number;
  v1: number;
}

export function extent_of(place: Place, cells: Index3): Extent {
  const { u, v } = FRAMES[place.axis];
  const size = TILE * 2 ** place.level;
  const end = (n: number, at: number) => Math.min(n, (at + 1) * size);
  return { u0: place.column * size, u1: end(cells[u], place.column), v0: place.row * size, v1: end(cells[v], place.row) };
}

// The tile of a coarser level that covers this one.
export function coarser(p: Place, levels: number): Place {
  return { axis: p.axis, index: p.index >> levels, level: p.level + levels, column: p.column >> levels, row: p.row >> levels };
}

// The same tile in another slice, which is given as a cell of level 0.
export const in_slice = (p: Place, slice: number): Place => ({ ...p, index: slice >> p.level });
