// The leaves of the refined grid over the cells of a slice: lines between them, in a colour for each level. A pixel is drawn on where a leaf begins,
// on the left or below, that is at least two pixels wide or high, as `teracell slice --refine` does.
import { FINER, type LeafTile } from "../../tiles/leaf_tile";
import { TILE } from "../../tiles/place";
import type { Region } from "../../tiles/regions";
import { type Rgb, packed } from "../../tiles/sets";
import type { SampleCells } from "./camera";

// From fine to coarse: from red over yellow and green to blue, and round again, darker each time.
const COLORS: readonly Rgb[] = [
  [200, 30, 30],
  [230, 110, 20],
  [205, 165, 0],
  [110, 170, 40],
  [20, 150, 110],
  [20, 130, 200],
  [50, 70, 190],
  [120, 50, 160],
];
export function color_of_level(level: number): Rgb {
  const [r, g, b] = COLORS[level % COLORS.length]!;
  const darker = Math.floor(level / COLORS.length);
  return [r >> darker, g >> darker, b >> darker];
}

// The level of the leaf that each pixel shows; FINER where it shows several or none.
function levels_of(columns: Int32Array, rows: Int32Array, regions: readonly Region<LeafTile>[]): Uint8Array {
  const out = new Uint8Array(columns.length * rows.length).fill(FINER);
  for (const { tile, u0, u1, v0, v1 } of regions) {
    if (!tile) continue;
    const { level, column, row } = tile.place;
    for (let y = 0; y < rows.length; ++y) {
      const v = rows[y]!;
      if (v < v0 || v >= v1) continue;
      const base = ((v >> level) - row * TILE) * tile.width - column * TILE;
      for (let x = 0; x < columns.length; ++x) {
        const u = columns[x]!;
        if (u >= u0 && u < u1) out[y * columns.length + x] = tile.levels[base + (u >> level)]!;
      }
    }
  }
  return out;
}

export function paint_leaves(out: Uint32Array, { columns: all_columns, rows: all_rows, each }: SampleCells, regions: readonly Region<LeafTile>[]): void {
  const columns = all_columns.filter((_, i) => i % each === 0);
  const rows = all_rows.filter((_, i) => i % each === 0);
  const [width, height] = [columns.length, rows.length];
  const levels = levels_of(columns, rows, regions);
  const colors = Uint32Array.from({ length: FINER }, (_, level) => packed(color_of_level(level)));
  // Whether two pixels beside each other show the same leaf.
  const same = (a: number, b: number, cells: Int32Array, i: number, j: number) =>
    j >= 0 && j < cells.length && levels[a] === levels[b] && cells[i]! >> levels[a]! === cells[j]! >> levels[a]!;
  for (let y = 0, at = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, ++at) {
      const level = levels[at]!;
      if (level === FINER) continue;
      const left = !same(at, at - 1, columns, x, x - 1) && same(at, at + 1, columns, x, x + 1);
      if (left || (!same(at, at + width, rows, y, y + 1) && same(at, at - width, rows, y, y - 1))) out[at] = colors[level]!;
    }
}
