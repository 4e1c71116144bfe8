// In which order tiles are asked for:
// 1. where a view shows nothing of its slice, a coarse tile, for all views;
// 2. what is in sight: the view in use before the others, and tiles nearest to the pointer (or to the middle) first;
// 3. the next slices, in the direction in which slices moved last, and one slice in the other direction.
import type { Index3 } from "../base/grid";
import { type Extent, type Place, TILE, coarser, extent_of, in_slice, place_name } from "./place";
import type { Want } from "./store";

export interface ViewNeeds {
  readonly places: readonly Place[]; // in sight
  readonly missing: readonly Place[];
  readonly blank: readonly Place[];
  readonly slice: number;
  readonly stride: number; // by how much the slice moved last; 0: not yet
  readonly first: boolean; // whether it is the view in use
  readonly focus: readonly [number, number]; // the cell of level 0 under the pointer, or in the middle
}

const STAND_IN = 3; // levels coarser: one tile instead of 64
const AHEAD = 4; // slices ahead in the view in use
const MOST_AHEAD = 40; // tiles

// Counted in tiles of the level of the place.
function distance(place: Place, [u, v]: readonly [number, number], cells: Index3): number {
  const e: Extent = extent_of(place, cells);
  const size = TILE * 2 ** place.level;
  return Math.hypot((e.u0 + e.u1) / 2 - u, (e.v0 + e.v1) / 2 - v) / size;
}

// Steps to the slices that are likely to come next, soonest first.
const next_steps = (first: boolean): number[] => (first ? [...Array.from({ length: AHEAD }, (_, i) => i + 1), -1] : [1, -1]);

// A step leads at least to the next slice of the level.
const step_of = (stride: number, level: number): number => (Math.sign(stride) || 1) * Math.max(Math.abs(stride), 2 ** level);

export function wants_of(views: readonly ViewNeeds[], levels: number, cells: Index3): Want[] {
  const wants: Want[] = [];
  const named = new Set<string>();
  const add = (place: Place, ahead: boolean) => {
    const name = place_name(place);
    if (named.has(name)) return;
    named.add(name);
    wants.push({ place, ahead });
  };
  const ordered = [...views].sort((a, b) => Number(b.first) - Number(a.first));
  // A view that lacks only a few tiles gets them as soon as it would get a coarse one.
  for (const { blank } of ordered)
    if (blank.length > 2) for (const place of blank) add(coarser(place, Math.min(STAND_IN, levels - 1 - place.level)), false);
  for (const { missing, focus } of ordered)
    for (const place of [...missing].sort((a, b) => distance(a, focus, cells) - distance(b, focus, cells))) add(place, false);
  const ahead_from = wants.length;
  for (const { places, slice, stride, first } of ordered)
    for (const step of next_steps(first))
      for (const place of places) {
        const next = slice + step * step_of(stride, place.level);
        if (next >= 0 && next < cells[place.axis] && wants.length - ahead_from < MOST_AHEAD) add(in_slice(place, next), true);
      }
  return wants;
}
