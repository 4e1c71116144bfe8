// Turns labels into pixels, on the processor, one row of samples after another.
//
// Where cells are about as large as a pixel, each pixel has 2 x 2 samples. Their colours are averaged, first along the
// row and then with the row below. Samples are then closer together than cells are large, so no cell is left out, and
// edges are smooth. Where cells are several pixels large, each pixel has one sample, and edges are sharp. A row of
// samples that lies in the same cells as the row above is not computed again.
//
// Why not WebGL: a view has about a million pixels, each of which needs a few look-ups. On the processor that takes as
// long without a graphics card (in the tests, over a remote desktop) as with one. There is no context to lose and
// nothing to upload, and a test in Node can compare the picture with the cells one by one.
import { TILE } from "../../tiles/place";
import type { Region } from "../../tiles/regions";
import { OUTSIDE, UNKNOWN } from "../../tiles/sets";
import { set_at } from "../../tiles/tile";
import type { SampleCells } from "./camera";

// The half-open range of the places whose value lies in [from, to). REQUIRES: the values are sorted, and -1 occurs only
// at the ends.
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
  readonly columns: Int32Array; // in the tile, for each sample from x0 on
  readonly colors: Uint32Array; // by the tile's own numbers of sets
}

function patches_of(samples: SampleCells, regions: readonly Region[], colors: Uint32Array): Patch[] {
  return regions.flatMap((region) => {
    const [x0, x1] = range_of(samples.columns, region.u0, region.u1);
    const [y0, y1] = range_of(samples.rows, region.v0, region.v1);
    if (x0 === x1 || y0 === y1) return [];
    const { tile } = region;
    if (!tile) return [{ region, x0, x1, y0, y1, columns: new Int32Array(0), colors }];
    const { level, column } = tile.place;
    const columns = samples.columns.slice(x0, x1).map((u) => (u >> level) - column * TILE);
    return [{ region, x0, x1, y0, y1, columns, colors: tile.sets.map((set) => colors[set]!) }];
  });
}

// The number of the set at a sample.
export function number_at(samples: SampleCells, regions: readonly Region[], x: number, y: number): number {
  const [u, v] = [samples.columns[x] ?? -1, samples.rows[y] ?? -1];
  const region = u < 0 || v < 0 ? undefined : regions.find((r) => u >= r.u0 && u < r.u1 && v >= r.v0 && v < r.v1);
  if (!region) return OUTSIDE;
  return region.tile ? set_at(region.tile, u, v) : UNKNOWN;
}

// The mean of two packed colours, channel by channel, rounded up.
const mean = (a: number, b: number): number => ((a | b) - (((a ^ b) & 0xfefefefe) >>> 1)) >>> 0;

// The colours of one row of samples. Samples of the same pixel are averaged.
function fill_line(
  line: Uint32Array,
  y: number,
  samples: SampleCells,
  regions: readonly Region[],
  patches: readonly Patch[],
  colors: Uint32Array,
): void {
  const { each } = samples;
  line.fill(colors[OUTSIDE]!);
  for (const { region, x0, x1, y0, y1, columns, colors: own } of patches) {
    if (y < y0 || y >= y1) continue;
    const [from, to] = [Math.ceil(x0 / each), Math.floor(x1 / each)]; // whole pixels
    const { tile } = region;
    if (!tile?.labels) line.fill(tile ? own[0]! : colors[UNKNOWN]!, from, to);
    else {
      const { labels } = tile;
      const base = ((samples.rows[y]! >> tile.place.level) - tile.place.row * TILE) * tile.width;
      if (each === 1) for (let x = from; x < to; ++x) line[x] = own[labels[base + columns[x - x0]!]!]!;
      else
        for (let x = from, s = 2 * from - x0; x < to; ++x, s += 2) {
          const a = labels[base + columns[s]!]!;
          const b = labels[base + columns[s + 1]!]!;
          line[x] = a === b ? own[a]! : mean(own[a]!, own[b]!);
        }
    }
    // A pixel that two regions share.
    for (const x of each === 1 ? [] : [x0, x1])
      if (x % 2 === 1) line[x >> 1] = mean(colors[number_at(samples, regions, x - 1, y)]!, colors[number_at(samples, regions, x, y)]!);
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

// Fills `out` with packed colours, one per pixel of `each` x `each` samples.
export function paint(out: Uint32Array, samples: SampleCells, regions: readonly Region[], colors: Uint32Array): void {
  const { each, rows } = samples;
  const width = samples.columns.length / each;
  const patches = patches_of(samples, regions, colors);
  let line = new Uint32Array(width);
  let other = new Uint32Array(width);
  const next = (y: number) => {
    if (y > 0 && equals_above(rows, y, patches)) return;
    [line, other] = [other, line];
    fill_line(line, y, samples, regions, patches, colors);
  };
  for (let y = 0, at = 0; y < rows.length; y += each, at += width) {
    next(y);
    out.set(line, at);
    if (each === 1) continue;
    const above = line;
    next(y + 1);
    if (line === above) continue;
    for (let x = 0; x < width; ++x) {
      const a = above[x]!;
      const b = line[x]!;
      if (a !== b) out[at + x] = mean(a, b);
    }
  }
}

// The numbers of the sets at each sample, one row after another. A row holds until the next one is taken.
export class NumberRows {
  private readonly samples: SampleCells;
  private readonly patches: readonly Patch[];
  private readonly numbers: Uint32Array;
  private readonly line: Uint32Array;

  constructor({ columns, rows }: SampleCells, private readonly regions: readonly Region[]) {
    this.samples = { columns, rows, each: 1 };
    this.numbers = as_colors(regions);
    this.patches = patches_of(this.samples, regions, this.numbers);
    this.line = new Uint32Array(columns.length);
  }
  // Whether row y is like the row above it.
  repeats(y: number): boolean {
    return y > 0 && equals_above(this.samples.rows, y, this.patches);
  }
  row(y: number): Uint32Array {
    fill_line(this.line, y, this.samples, this.regions, this.patches, this.numbers);
    return this.line;
  }
}

// "Colours" that are the numbers of the sets themselves.
function as_colors(regions: readonly Region[]): Uint32Array {
  const most = regions.reduce((n, { tile }) => tile?.sets.reduce((m, set) => Math.max(m, set), n) ?? n, UNKNOWN);
  return Uint32Array.from({ length: most + 1 }, (_, i) => i);
}

// Puts a packed colour on each pixel whose set differs from that of the pixel on its left or above it. Mixed cells count as what owns them.
export function paint_outline(out: Uint32Array, samples: SampleCells, regions: readonly Region[], color: number): void {
  const { each, rows } = samples;
  const width = samples.columns.length / each;
  // Paints the numbers of the sets as if they were colours, from the first sample of each pixel.
  const firsts: SampleCells = { columns: samples.columns.filter((_, i) => i % each === 0), rows: rows.filter((_, i) => i % each === 0), each: 1 };
  const numbers = new Uint32Array(out.length);
  const owners = as_colors(regions);
  for (const { tile } of regions) tile?.sets.forEach((set, i) => (owners[set] = tile.owners[i]!));
  paint(numbers, firsts, regions, owners);
  for (let i = width; i < numbers.length; ++i) {
    const here = numbers[i]!;
    if ((here !== numbers[i - 1] && i % width !== 0) || here !== numbers[i - width]) out[i] = color;
  }
}

// Draws stripes where the file can't be read, so that nobody takes it for air or for a material.
export function paint_damaged(out: Uint32Array, samples: SampleCells, regions: readonly Region[], dark: number, light: number): void {
  const { each } = samples;
  const width = samples.columns.length / each;
  for (const { region, x0, x1, y0, y1 } of patches_of(samples, regions.filter(({ damaged }) => damaged), new Uint32Array(2))) {
    const { tile } = region;
    const is_lost = (x: number, y: number) => !tile || set_at(tile, samples.columns[x * each]!, samples.rows[y * each]!) === tile.unreadable;
    for (let y = Math.ceil(y0 / each); y < Math.ceil(y1 / each); ++y)
      for (let x = Math.ceil(x0 / each); x < Math.ceil(x1 / each); ++x) if (is_lost(x, y)) out[y * width + x] = ((x + y) & 15) < 3 ? dark : light;
  }
}
