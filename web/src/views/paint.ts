// Labels to pixels, on the processor. First the number of the set under each pixel, from the tiles of the regions, then its colour:
// a look that changes repeats only the second. Both copy a row that equals the one above it.
//
// Not WebGL: a view is at most a few million pixels, each two look-ups, about 2 ms a million, which the screenshots in README
// and any remote desktop without a graphics card get as well (there the same picture by shaders costs many times that); and there is
// no context to lose, nothing to upload, and a picture that a test in Node can hold against cells one by one.
import type { Region } from "../tiles/regions";
import { OUTSIDE, UNKNOWN } from "../tiles/sets";
import { TILE } from "../tiles/place";
import type { Tile } from "../tiles/tile";
import type { PixelCells } from "./camera";

// Half open range of the places whose value is in [from, to), of values that ascend, -1 only at the ends.
function range_of(cells: Int32Array, from: number, to: number): [number, number] {
  let low = 0;
  while (low < cells.length && (cells[low]! < from || cells[low]! >= to)) ++low;
  let high = cells.length;
  while (high > low && (cells[high - 1]! < from || cells[high - 1]! >= to)) --high;
  return [low, high];
}

function paint_tile(numbers: Uint32Array, width: number, pixels: PixelCells, tile: Tile, x0: number, x1: number, y0: number, y1: number): void {
  const { level, column, row } = tile.place;
  const { labels, sets } = tile;
  if (!labels) {
    for (let y = y0; y < y1; ++y) numbers.fill(sets[0]!, y * width + x0, y * width + x1);
    return;
  }
  const count = x1 - x0;
  const local = new Int32Array(count);
  for (let i = 0; i < count; ++i) local[i] = (pixels.columns[x0 + i]! >> level) - column * TILE;
  let above = -1;
  for (let y = y0; y < y1; ++y) {
    const at = y * width + x0;
    const from = (pixels.rows[y]! >> level) - row * TILE;
    if (from === above) numbers.copyWithin(at, at - width, at - width + count);
    else {
      const base = from * tile.width;
      for (let i = 0; i < count; ++i) numbers[at + i] = sets[labels[base + local[i]!]!]!;
    }
    above = from;
  }
}

// REQUIRES: numbers has a place for each pixel.
export function paint_numbers(numbers: Uint32Array, pixels: PixelCells, regions: readonly Region[]): void {
  const width = pixels.columns.length;
  numbers.fill(OUTSIDE);
  for (const region of regions) {
    const [x0, x1] = range_of(pixels.columns, region.u0, region.u1);
    const [y0, y1] = range_of(pixels.rows, region.v0, region.v1);
    if (region.tile) paint_tile(numbers, width, pixels, region.tile, x0, x1, y0, y1);
    else for (let y = y0; y < y1; ++y) numbers.fill(UNKNOWN, y * width + x0, y * width + x1);
  }
}

// `outline`: a packed colour for pixels whose set differs from that on the left or above.
export function paint_colors(out: Uint32Array, numbers: Uint32Array, width: number, colors: Uint32Array, outline: number | null): void {
  for (let i = 0; i < numbers.length; ++i) out[i] = colors[numbers[i]!]!;
  if (outline === null) return;
  for (let i = width; i < numbers.length; ++i) {
    const here = numbers[i]!;
    if ((here !== numbers[i - 1] && i % width !== 0) || here !== numbers[i - width]) out[i] = outline;
  }
}

// Stripes where the server can't read the file: not air, and not a material.
export function paint_damaged(out: Uint32Array, pixels: PixelCells, regions: readonly Region[], dark: number, light: number): void {
  const width = pixels.columns.length;
  for (const region of regions) {
    if (!region.damaged) continue;
    const [x0, x1] = range_of(pixels.columns, region.u0, region.u1);
    const [y0, y1] = range_of(pixels.rows, region.v0, region.v1);
    for (let y = y0; y < y1; ++y) for (let x = x0; x < x1; ++x) out[y * width + x] = ((x + y) >> 3) & 1 ? dark : light;
  }
}
