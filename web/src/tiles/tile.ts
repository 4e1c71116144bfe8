// A tile as the server sends it (`.bin?sets=1`, which for mixed cells may have lists of shares in place of sets), little-endian:
// - u16: the number of sets; u16: flags;
// - for each set, u16: the number of its labels, then these as u16; with the flag WIDE all of them as u32;
// - for each cell, row v = 0 first, the number of its set: u8 when there are at most 256 sets, otherwise u16.
// The cells are not copied: reading a tile only costs the work for its few sets.
import { type Place, TILE, place_name } from "./place";
import type { SetTable } from "./sets";

export interface Tile {
  readonly place: Place;
  readonly name: string;
  readonly width: number;
  readonly height: number;
  readonly sets: Uint32Array; // numbers in the SetTable
  readonly owners: Uint32Array; // the same, as they are without the shares of mixed cells
  readonly labels: Uint8Array | Uint16Array | null; // places in `sets`; null when sets[0] is everywhere
  readonly unreadable?: number | null; // the one of `sets` that stands for what can't be read, if a cell has it
  readonly damaged?: boolean; // as of all that a store holds
  readonly apart: boolean; // false: too many bodies are in sight here, so each label stands for all bodies of its material
  readonly bytes: number; // that it holds in memory
}

const WIDE = 1; // flags
const NOT_APART = 2;
const OVERHEAD = 256; // bytes of the objects around the cells

interface Cells {
  readonly sets: Uint32Array; // numbers in the SetTable
  readonly labels: Uint8Array | Uint16Array | null; // places in `sets`; null when sets[0] is everywhere
  readonly flags: number;
  readonly bytes: number;
}

// The cells of a tile, or of a plane. `what` names it in errors.
export function decode_sets(what: string, [width, height]: readonly [number, number], buffer: ArrayBuffer, table: SetTable): Cells {
  const wrong = (expected: string) => new Error(`${what}: expected ${expected}, found ${buffer.byteLength} bytes`);
  const view = new DataView(buffer);
  if (buffer.byteLength < 4) throw wrong("a header of 4 bytes");
  const count = view.getUint16(0, true);
  const flags = view.getUint16(2, true);
  const width_of = flags & WIDE ? 4 : 2; // bytes of a number
  const number_at = (place: number) => (flags & WIDE ? view.getUint32(place, true) : view.getUint16(place, true));
  const sets = new Uint32Array(count);
  let at = 4;
  for (let s = 0; s < count; ++s) {
    if (at + width_of > buffer.byteLength) throw wrong(`${count} sets`);
    const n = number_at(at);
    at += width_of;
    if (at + width_of * n > buffer.byteLength) throw wrong(`${count} sets`);
    sets[s] = table.number_of(Array.from({ length: n }, (_, i) => number_at(at + width_of * i)));
    at += width_of * n;
  }
  const cells = width * height;
  const wide = count > 256;
  const length = at + cells * (wide ? 2 : 1);
  if (count === 0 || buffer.byteLength !== length) throw wrong(`${length} bytes for ${width} x ${height} cells and ${count} sets`);
  if (count === 1) return { sets, labels: null, flags, bytes: 0 };
  return { sets, labels: wide ? new Uint16Array(buffer, at, cells) : new Uint8Array(buffer, at, cells), flags, bytes: length };
}

export function decode_tile(place: Place, size: readonly [number, number], buffer: ArrayBuffer, table: SetTable): Tile {
  const name = place_name(place);
  const { sets, labels, flags, bytes } = decode_sets(`tile ${name}`, size, buffer, table);
  const owners = sets.map((set) => table.owner(set));
  const place_of = sets.findIndex((set) => table.members(set)?.length === 0);
  const unreadable = place_of < 0 || labels?.includes(place_of) === false ? null : sets[place_of]!;
  return { place, name, width: size[0], height: size[1], sets, owners, labels, unreadable, apart: (flags & NOT_APART) === 0, bytes: OVERHEAD + bytes };
}

// The number of the set at a cell of level 0. REQUIRES: the cell lies in the tile.
export function set_at(tile: Tile, u: number, v: number): number {
  const { level, column, row } = tile.place;
  const at = ((v >> level) - row * TILE) * tile.width + (u >> level) - column * TILE;
  return tile.sets[tile.labels ? tile.labels[at]! : 0]!;
}
