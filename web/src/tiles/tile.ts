// A tile as the server sends it (`.bin?sets=1`), little-endian:
// - u16: the number of sets; u16: 0;
// - for each set, u16: the number of its materials, then their ids as u16;
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
  readonly labels: Uint8Array | Uint16Array | null; // places in `sets`; null when sets[0] is everywhere
  readonly bytes: number; // that it holds in memory
}

const OVERHEAD = 256; // bytes of the objects around the cells

export function decode_tile(place: Place, size: readonly [number, number], buffer: ArrayBuffer, table: SetTable): Tile {
  const name = place_name(place);
  const wrong = (expected: string) => new Error(`tile ${name}: expected ${expected}, found ${buffer.byteLength} bytes`);
  const view = new DataView(buffer);
  if (buffer.byteLength < 4) throw wrong("a header of 4 bytes");
  const count = view.getUint16(0, true);
  const sets = new Uint32Array(count);
  let at = 4;
  for (let s = 0; s < count; ++s) {
    if (at + 2 > buffer.byteLength) throw wrong(`${count} sets`);
    const n = view.getUint16(at, true);
    at += 2;
    if (at + 2 * n > buffer.byteLength) throw wrong(`${count} sets`);
    sets[s] = table.number_of(Array.from({ length: n }, (_, i) => view.getUint16(at + 2 * i, true)));
    at += 2 * n;
  }
  const [width, height] = size;
  const cells = width * height;
  const wide = count > 256;
  const length = at + cells * (wide ? 2 : 1);
  if (count === 0 || buffer.byteLength !== length) throw wrong(`${length} bytes for ${width} x ${height} cells and ${count} sets`);
  if (count === 1) return { place, name, width, height, sets, labels: null, bytes: OVERHEAD };
  const labels = wide ? new Uint16Array(buffer, at, cells) : new Uint8Array(buffer, at, cells);
  return { place, name, width, height, sets, labels, bytes: OVERHEAD + length };
}

// The number of the set at a cell of level 0. REQUIRES: the cell lies in the tile.
export function set_at(tile: Tile, u: number, v: number): number {
  const { level, column, row } = tile.place;
  const at = ((v >> level) - row * TILE) * tile.width + (u >> level) - column * TILE;
  return tile.sets[tile.labels ? tile.labels[at]! : 0]!;
}
