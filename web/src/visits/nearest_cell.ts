// The cell nearest to a place that has one of some labels, by shares of the sides of their box: of a wide, flat hall the stands at the sides are
// nearer to its middle than the floor below, and a slice through them shows more. It is looked for in the slices through the place: what hangs
// together in one piece has cells in each slice that cuts its box. In a box too large for the cells of a few tiles it is looked for on a coarser
// level, and from there downwards in the cells that the one found holds.
import { FRAMES } from "../base/axis";
import { AXES, type AxisIndex, type Index3, for_axes } from "../base/grid";
import { get } from "../server/api";
import type { Box, Viewer } from "../state/viewer";
import { type Place, TILE, tile_size } from "../tiles/place";
import { SetTable } from "../tiles/sets";
import { type Tile, decode_tile } from "../tiles/tile";

// Cells of a level, half open.
type Window = Box;
export type FetchTile = (place: Place) => Promise<Tile>;
// Whether a set of a tile has one of the labels.
export type IsWanted = (set: number, tile: Tile) => boolean;
interface Found {
  readonly cell: Index3; // of a level
  readonly away: number; // the square of its distance
}

const shifted = (box: Box, level: number): Window => box.map((end, n) => (n < 3 ? end >> level : ((end - 1) >> level) + 1)) as Window;

// Where it is looked for: a box, and a place in it, in cells of level 0.
interface Wanted {
  readonly is_wanted: IsWanted;
  readonly box: Box;
  readonly to: Index3;
}

// The nearest of the cells of a tile within a window.
function nearest_in_tile(tile: Tile, { is_wanted, box, to }: Wanted, window: Window): Found | null {
  const { axis, index, level, column, row } = tile.place;
  const { u, v } = FRAMES[axis];
  const has = Array.from(tile.sets, (set) => is_wanted(set, tile));
  if (!has.includes(true)) return null;
  const off = (d: AxisIndex, i: number) => (((i + 0.5) * 2 ** level - to[d] - 0.5) / (box[d + 3]! - box[d])) ** 2;
  const [u0, v0] = [column * TILE, row * TILE];
  const [from, end] = [Math.max(window[u], u0), Math.min(window[u + 3]!, u0 + tile.width)];
  let [a, b, least] = [-1, -1, Infinity];
  for (let j = Math.max(window[v], v0); j < Math.min(window[v + 3]!, v0 + tile.height); ++j) {
    const above = off(v, j);
    if (above >= least) continue;
    for (let i = from; i < end; ++i) {
      if (!has[tile.labels ? tile.labels[(j - v0) * tile.width + i - u0]! : 0]) continue;
      const away = above + off(u, i);
      if (away < least) [a, b, least] = [i, j, away];
    }
  }
  if (a < 0) return null;
  return { cell: for_axes((d) => (d === u ? a : d === v ? b : index)), away: least + off(axis, index) };
}

const nearer = (a: Found | null, b: Found | null): Found | null => (!a || (b && b.away < a.away) ? b : a);

async function nearest_in_slice(fetch_tile: FetchTile, wanted: Wanted, axis: AxisIndex, index: number, level: number, window: Window): Promise<Found | null> {
  const { u, v } = FRAMES[axis];
  const tiles: Promise<Tile>[] = [];
  for (let row = window[v] >> 9; row <= (window[v + 3]! - 1) >> 9; ++row)
    for (let column = window[u] >> 9; column <= (window[u + 3]! - 1) >> 9; ++column) tiles.push(fetch_tile({ axis, index, level, column, row }));
  return (await Promise.all(tiles)).map((tile) => nearest_in_tile(tile, wanted, window)).reduce(nearer, null);
}

// REQUIRES: `box` holds all cells of the labels, and touches some of them with each of its sides. Null when the file tells no cell of them apart.
export async function nearest_cell(viewer: Viewer, labels: readonly number[], box: Box, to: Index3, signal?: AbortSignal): Promise<Index3 | null> {
  const { address, cells, info } = viewer;
  const sets = new SetTable();
  const fetch_tile: FetchTile = async (place) => {
    const response = await get(address.tile(place.axis, place.index, place.level, place.column, place.row), { ...(signal && { signal }) });
    return decode_tile(place, tile_size(place, cells), await response.arrayBuffer(), sets);
  };
  const wanted = new Set(labels);
  const materials = new Set(labels.map((label) => viewer.labels[label]!.material));
  const is_wanted: IsWanted = (set, { apart }) =>
    (sets.members(set) ?? []).some((label) => (apart ? wanted.has(label) : materials.has(viewer.labels[label]!.material)));
  return nearest_of(fetch_tile, { is_wanted, box, to }, info.levels.length);
}

export async function nearest_of(fetch_tile: FetchTile, wanted: Wanted, levels: number): Promise<Index3 | null> {
  const { box, to } = wanted;
  const longest = Math.max(...AXES.map((d) => box[d + 3]! - box[d]));
  const level = Math.min(Math.max(0, Math.ceil(Math.log2(longest / TILE))), Math.max(levels - 1, 0));
  const within = (at: number) => shifted(box, at);
  const across = (axis: AxisIndex, index: number) => nearest_in_slice(fetch_tile, wanted, axis, index, level, within(level));
  // First the slice across z alone; where its middle is something else, the others may come nearer.
  let found = await across(2, to[2] >> level);
  if (!found || AXES.some((d) => found!.cell[d] !== to[d] >> level))
    found = (await Promise.all([across(0, to[0] >> level), across(1, to[1] >> level)])).reduce(nearer, found);
  // Several pieces may lie beside all three slices; some cell touches the lower side of the box.
  found ??= await across(2, within(level)[2]);
  for (let finer = level - 1; found && finer >= 0; --finer) {
    const [held, all] = [found.cell, within(finer)];
    const inside = AXES.map((d) => Math.max(2 * held[d], all[d])).concat(AXES.map((d) => Math.min(2 * held[d] + 2, all[d + 3]!))) as Window;
    const layers = Array.from({ length: inside[5] - inside[2] }, (_, k) => nearest_in_slice(fetch_tile, wanted, 2, inside[2] + k, finer, inside));
    found = (await Promise.all(layers)).reduce(nearer, null);
  }
  return found?.cell ?? null;
}
