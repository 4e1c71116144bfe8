// A tile of leaves as the server sends it: for each cell of the tile, row v = 0 first, one byte, the level of the leaf that holds it.
import { type Place, place_name } from "./place";

export const FINER = 255; // the cell holds several leaves

export interface LeafTile {
  readonly place: Place;
  readonly name: string;
  readonly width: number;
  readonly levels: Uint8Array;
  readonly bytes: number; // that it takes in memory
}

export function decode_leaf_tile(place: Place, [width, height]: readonly [number, number], buffer: ArrayBuffer): LeafTile {
  const name = place_name(place);
  if (buffer.byteLength !== width * height)
    throw new Error(`tile ${name}: expected ${width * height} bytes for ${width} x ${height} cells, found ${buffer.byteLength} bytes`);
  return { place, name, width, levels: new Uint8Array(buffer), bytes: buffer.byteLength };
}
