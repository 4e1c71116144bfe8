// What to draw while tiles are on their way. Every place of the view is drawn once, from the best tile that is there:
// 1. its own tile;
// 2. a slightly coarser tile of the same slice;
// 3. finer tiles of the same slice, which are there after zooming out;
// 4. for a moment, what was shown before: the next slice usually comes within that time, so nothing flickers;
// 5. any coarser tile of the same slice;
// 6. whatever was shown before.
import { FRAMES } from "../base/axis";
import type { Index3 } from "../base/grid";
import { type Extent, type Place, coarser, extent_of, in_slice } from "./place";
import type { Held } from "./store";
import type { Tile } from "./tile";

export interface Region<T = Tile> extends Extent {
  readonly tile: T | null;
  readonly damaged: boolean; // some of it can't be read; without a tile, all
}

export interface Holder<T = Tile> {
  find(place: Place): T | null;
  is_damaged(place: Place): boolean;
}

export interface Shown<T = Tile> {
  readonly regions: Region<T>[];
  readonly missing: Place[]; // wanted and not there
  readonly blank: Place[]; // those of them for which no tile of this slice stands in, or only a very coarse one
  readonly stale: boolean; // whether some of it shows another slice
}

export interface Before {
  readonly slice: number | null; // the one that was shown last
  readonly patient: boolean; // whether it may stay although a coarse tile of the right slice is there
}

const NEAR = 2; // levels: a tile that is coarser by at most this many looks like the same picture, a little blurred
const DEEP = 2; // levels: finer tiles are looked for this deep

// REQUIRES: places of one slice (a cell of level 0), as cover() gives them.
export function regions_of<T extends Held = Tile>(
  places: readonly Place[],
  slice: number,
  levels: number,
  cells: Index3,
  held: Holder<T>,
  before: Before,
): Shown<T> {
  const regions: Region<T>[] = [];
  const missing: Place[] = [];
  const blank = new Set<Place>();
  let stale = false;
  const add = (place: Place, tile: T | null, damaged = tile?.damaged ?? false) => regions.push({ ...extent_of(place, cells), tile, damaged });

  const coarse = (place: Place, from: number, to: number): T | null => {
    for (let by = from; by <= to && place.level + by < levels; ++by) {
      const tile = held.find(coarser(place, by));
      if (tile) return tile;
    }
    return null;
  };
  const stand_in = (place: Place, wanted: Place): void => {
    const near = coarse(place, 1, NEAR + wanted.level - place.level);
    if (near) {
      add(place, near);
      return;
    }
    blank.add(wanted);
    const old = before.slice === null ? null : coarse(in_slice(place, before.slice), 0, levels);
    const any = old && before.patient ? null : coarse(place, 1, levels);
    stale ||= !any && old !== null;
    add(place, any ?? old);
  };
  const quarters = (place: Place): Place[] =>
    [0, 1, 2, 3]
      .map((q) => ({
        ...place,
        index: slice >> (place.level - 1),
        level: place.level - 1,
        column: 2 * place.column + (q & 1),
        row: 2 * place.row + (q >> 1),
      }))
      .filter((quarter) => extent_of(quarter, cells).u0 < cells[FRAMES[place.axis].u] && extent_of(quarter, cells).v0 < cells[FRAMES[place.axis].v]);
  const has_finer = (place: Place, depth: number): boolean =>
    depth > 0 && place.level > 0 && quarters(place).some((quarter) => held.find(quarter) !== null || has_finer(quarter, depth - 1));
  const draw_finer = (place: Place, depth: number, wanted: Place): void => {
    for (const quarter of quarters(place)) {
      const tile = held.find(quarter);
      if (tile) add(quarter, tile);
      else if (has_finer(quarter, depth - 1)) draw_finer(quarter, depth - 1, wanted);
      else stand_in(quarter, wanted);
    }
  };

  for (const place of places) {
    const tile = held.find(place);
    if (tile) add(place, tile);
    else if (held.is_damaged(place)) add(place, null, true);
    else {
      missing.push(place);
      if (!coarse(place, 1, NEAR) && has_finer(place, DEEP)) draw_finer(place, DEEP, place);
      else stand_in(place, place);
    }
  }
  return { regions, missing, blank: [...blank], stale };
}
