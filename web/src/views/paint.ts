// Labels to pixels, on the processor, row by row: the numbers of the sets at each sample of a row, from the tiles of the regions,
// then their colours. Rows that equal the one above are copied.
//
// Cells of about a pixel get 2 x 2 samples a pixel, whose colours are averaged: samples are closer than cells are large, so that none is
// left out, and edges are smooth. Cells of several pixels get one: they have sharp edges.
//
// Not WebGL: a view has about a million pixels, each needs a few look-ups. That takes as long without a graphics card (in the
// tests, over a remote desktop) as with one; there is no context to lose and nothing to upload, and a test in Node can hold the
// picture against the cells one by one.
import { TILE } from "../tiles/place";
import type { Region } from "../tiles/regions";
import { OUTSIDE, UNKNOWN } from "../tiles/sets";
import type { SampleCells } from "./camera";

// Half open range of the places whose value is in [from, to), of values in order, -1 only at the ends.
function range_of(cells: Int32Array, from: number, to: number): [number, number] {
  let low = 0;
  while (low < cells.length && (cells[low]! < from || cells[low]! >= to)) ++low;
  let high = cells.length;
  while (high > low && (cells[high - 1]! < from || cells[high - 1]! >= to)) --high;
  return [low, high];
}

interface Patch {
  readonly region: Region;
  readonly x0: number; // samples
  readonly x1: number;
  readonly y0: number;
  readonly y1: number;
  readonly columns: Int32Array; // of the tile, for each sample from x0 on
}

function patches_of(samples: SampleCells, regions: readonly Region[]): Patch[] {
  return regions.flatMap((region) => {
    const [x0, x1] = range_of(samples.columns, region.u0, region.u1);
    const [y0, y1] = range_of(samples.rows, region.v0, region.v1);
    if (x0 === x1 || y0 === y1) return [];
    const place = region.tile?.place;
    const columns = place ? samples.columns.slice(x0, x1).map((u) => (u >> place.level) - place.column * TILE) : new Int32Array(0);
    return [{ region, x0, x1, y0, y1, columns }];
  });
}

// The numbers of the sets of one row of samples.
function fill_row(line: Uint32Array, y: number, v: number, patches: readonly Patch[]): void {
  line.fill(OUTSIDE);
  for (const { region, x0, x1, y0, y1, columns } of patches) {
    if (y < y0 || y >= y1) continue;
    const { tile } = region;
    if (!tile?.labels) {
      line.fill(tile ? tile.sets[0]! : UNKNOWN, x0, x1);
      continue;
    }
    const { labels, sets } = tile;
    const base = ((v >> tile.place.level) - tile.place.row * TILE) * tile.width;
    const count = x1 - x0;
    for (let i = 0; i < count; ++i) line[x0 + i] = sets[labels[base + columns[i]!]!]!;
  }
}

// Whether sample rows y - 1 and y show the same cells.
function equals_above(rows: Int32Array, y: number, patches: readonly Patch[]): boolean {
  const [above, here] = [rows[y - 1]!, rows[y]!];
  if (above === here) return true;
  if (above < 0 || here < 0) return false;
  return patches.every(({ region, y0, y1 }) => {
    const [a, b] = [y > y0 && y <= y1, y >= y0 && y < y1];
    const level = region.tile?.place.level ?? 0;
    return (!a && !b) || (a && b && (!region.tile?.labels || above >> level === here >> level));
  });
}

const LANES = 0xff00ff; // two channels at once

function mean(a: number, b: number, c: number, d: number): number {
  const even = ((a & LANES) + (b & LANES) + (c & LANES) + (d & LANES) + 0x20002) >>> 2;
  const odd = (((a >>> 8) & LANES) + ((b >>> 8) & LANES) + ((c >>> 8) & LANES) + ((d >>> 8) & LANES) + 0x20002) >>> 2;
  return ((even & LANES) | ((odd & LANES) << 8)) >>> 0;
}

// `out`: packed colours, `numbers`: of the sets, both of width x height pixels.
export function paint(out: Uint32Array, numbers: Uint32Array, samples: SampleCells, regions: readonly Region[], colors: Uint32Array): void {
  const { columns, rows, each } = samples;
  const [width, height] = [columns.length / each, rows.length / each];
  const patches = patches_of(samples, regions);
  const first = new Uint32Array(columns.length);
  const second = each === 2 ? new Uint32Array(columns.length) : first;
  for (let row = 0; row < height; ++row) {
    const y = row * each;
    const at = row * width;
    const last = y + each - 1;
    const repeated = row > 0 && equals_above(rows, y, patches);
    const flat = each === 1 || equals_above(rows, last, patches);
    if (repeated && flat && (each === 1 || equals_above(rows, y - 1, patches))) {
      out.copyWithin(at, at - width, at);
      numbers.copyWithin(at, at - width, at);
      continue;
    }
    if (repeated && each === 2) first.set(second);
    else fill_row(first, y, rows[y]!, patches);
    if (each === 1) {
      for (let x = 0; x < width; ++x) out[at + x] = colors[first[x]!]!;
      numbers.set(first, at);
      continue;
    }
    if (flat) second.set(first);
    else fill_row(second, last, rows[last]!, patches);
    for (let x = 0; x < width; ++x) {
      const a = first[2 * x]!;
      const b = first[2 * x + 1]!;
      const c = second[2 * x]!;
      const d = second[2 * x + 1]!;
      numbers[at + x] = a;
      out[at + x] = a === b && c === d && a === c ? colors[a]! : mean(colors[a]!, colors[b]!, colors[c]!, colors[d]!);
    }
  }
}

// A packed colour on pixels whose set differs from that on the left or above.
export function paint_outline(out: Uint32Array, numbers: Uint32Array, width: number, color: number): void {
  for (let i = width; i < numbers.length; ++i) {
    const here = numbers[i]!;
    if ((here !== numbers[i - 1] && i % width !== 0) || here !== numbers[i - width]) out[i] = color;
  }
}

// Stripes where the server can't read the file: not air, and not a material.
export function paint_damaged(out: Uint32Array, samples: SampleCells, regions: readonly Region[], dark: number, light: number): void {
  const { each } = samples;
  const width = samples.columns.length / each;
  for (const { x0, x1, y0, y1 } of patches_of(samples, regions.filter((region) => region.damaged)))
    for (let y = Math.ceil(y0 / each); y < Math.ceil(y1 / each); ++y)
      for (let x = Math.ceil(x0 / each); x < Math.ceil(x1 / each); ++x) out[y * width + x] = ((x + y) & 15) < 3 ? dark : light;
}
