// In which order tiles are asked for: where nothing of the slice is there something coarse, for all views; then what is in sight,
// nearest to the pointer (or the middle) first, the view under the pointer before the others; then the next slices the way that
// slices went lately, and one the other way.
import type { Index3 } from "../base/grid";
import { type Extent, type Place, TILE, coarser, extent_of, in_slice, place_name } from "./place";
import type { Want } from "./store";

export interface ViewNeeds {
  readonly places: readonly Place[]; // in sight
  readonly missing: readonly Place[];
  readonly blank: readonly Place[];
  readonly slice: number;
  readonly stride: number; // what the slice last moved by; 0: not yet
  readonly first: boolean; // the view that is used
  readonly focus: readonly [number, number]; // cells of level 0: under the pointer, or the middle
}

const STAND_IN = 3; // levels coarser: one tile for 64
const AHEAD = 4; // slices, of the view that is used
const MOST_AHEAD = 40; // tiles

// In tiles of the place's own level.
function distance(place: Place, [u, v]: readonly [number, number], cells: Index3): number {
  const e: Extent = extent_of(place, cells);
  const size = TILE * 2 ** place.level;
  return Math.hypot((e.u0 + e.u1) / 2 - u, (e.v0 + e.v1) / 2 - v) / size;
}

// Steps to the slices that are likely to come next, soonest first.
const next_steps = (first: boolean): number[] => (first ? [...Array.from({ length: AHEAD }, (_, i) => i + 1), -1] : [1, -1]);

// At least to the next slice of the level.
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
  // A view that lacks a few tiles gets them as soon as a coarse one.
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
