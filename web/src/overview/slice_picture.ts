// The picture of a coarse slice for the overview: one tile, of the finest level at which the whole slice fits into a
// tile. It is coloured as in the views. What is transparent stays transparent. Graded axes are true to scale. Pure.
import { type Axis, FRAMES } from "../base/axis";
import type { AxisIndex } from "../base/grid";
import { type MaterialLook, shown_color } from "../base/materials";
import { TILE } from "../tiles/place";
import { SetTable } from "../tiles/sets";
import { type Tile, decode_tile } from "../tiles/tile";
import { type Axes, level_within } from "./level_axis";

export interface SlicePlace {
  readonly axis: AxisIndex;
  readonly index: number; // in cells of the level
  readonly level: number;
}

export interface Slice {
  readonly tile: Tile;
  readonly sets: readonly (readonly number[])[];
}

export interface Picture {
  readonly width: number;
  readonly height: number;
  readonly pixels: Uint8Array; // RGBA, premultiplied, row v = 0 first
  readonly used: readonly [number, number]; // the shares of its width and height that lie in the grid
}

export function slice_place(axes: Axes, axis: AxisIndex, cell: number, levels: number): SlicePlace {
  const { u, v } = FRAMES[axis];
  const level = level_within([axes[u].cells, axes[v].cells], TILE, levels);
  return { axis, level, index: Math.floor(cell / 2 ** level) };
}

export function decode_slice(axes: Axes, place: SlicePlace, bytes: ArrayBuffer): Slice {
  const { u, v } = FRAMES[place.axis];
  const across = (d: AxisIndex) => Math.ceil(axes[d].cells / 2 ** place.level);
  const table = new SetTable();
  const tile = decode_tile({ ...place, column: 0, row: 0 }, [across(u), across(v)], bytes, table);
  return { tile, sets: Array.from(tile.sets, (number) => table.members(number) ?? []) };
}

// The cell of the level for each pixel across an axis; null when pixels and cells are the same.
function cells_across(axis: Axis, level: number, pixels: number): Uint16Array | null {
  if (!axis.graded) return null;
  const step = (axis.max - axis.min) / pixels;
  return Uint16Array.from({ length: pixels }, (_, p) => Math.floor(axis.clamp(axis.cell_at(axis.min + (p + 0.5) * step)) / 2 ** level));
}

function packed_color(set: readonly number[], looks: readonly MaterialLook[]): number {
  const [r, g, b, a] = shown_color(set, looks);
  const over = (c: number) => Math.round((c * a) / 255);
  return ((a << 24) | (over(b) << 16) | (over(g) << 8) | over(r)) >>> 0;
}

export function slice_picture(axes: Axes, slice: Slice, looks: readonly MaterialLook[]): Picture {
  const { tile, sets } = slice;
  const { axis, level } = tile.place;
  const [u, v] = [axes[FRAMES[axis].u], axes[FRAMES[axis].v]];
  const width = u.graded ? TILE : tile.width;
  const height = v.graded ? TILE : tile.height;
  const columns = cells_across(u, level, width);
  const rows = cells_across(v, level, height);
  const colors = Uint32Array.from(sets, (set) => packed_color(set, looks));
  const pixels = new Uint32Array(width * height).fill(colors[0]!);
  const { labels } = tile;
  if (labels)
    for (let y = 0, at = 0; y < height; ++y) {
      const row = (rows ? rows[y]! : y) * tile.width;
      if (columns) for (let x = 0; x < width; ++x, ++at) pixels[at] = colors[labels[row + columns[x]!]!]!;
      else for (let x = 0; x < width; ++x, ++at) pixels[at] = colors[labels[row + x]!]!;
    }
  // The last cell of a level may reach past the end of a uniform axis.
  const used = (a: Axis, cells: number) => (a.graded ? 1 : a.cells / (cells * 2 ** level));
  return { width, height, pixels: new Uint8Array(pixels.buffer), used: [used(u, tile.width), used(v, tile.height)] };
}
