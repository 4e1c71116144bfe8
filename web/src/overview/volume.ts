// A block of cells in memory: the material of each cell, x fastest. It is put together from cubes of the virtual Zarr
// arrays. It runs in the worker, and all of it but decompressing is pure.
import type { Index3 } from "../base/grid";

export const CUBE = 64; // cells along each side of a cube

export interface Volume {
  readonly size: Index3;
  readonly labels: Uint8Array | Uint16Array;
}

// A cube as it is fetched: gzip around labels in C order [z][y][x], padded to full size at the upper ends.
export interface Cube {
  readonly place: Index3;
  readonly bytes: ArrayBuffer;
}

export function cubes_of(size: Index3): Index3[] {
  const count = size.map((n) => Math.ceil(n / CUBE));
  const places: Index3[] = [];
  for (let z = 0; z < count[2]!; ++z) for (let y = 0; y < count[1]!; ++y) for (let x = 0; x < count[0]!; ++x) places.push([x, y, z]);
  return places;
}

export function empty_volume(size: Index3, wide: boolean): Volume {
  const cells = size[0] * size[1] * size[2];
  return { size, labels: wide ? new Uint16Array(cells) : new Uint8Array(cells) };
}

// Copies the part of a cube that lies in the volume.
export function place_cube(volume: Volume, place: Index3, cube: Uint8Array | Uint16Array): void {
  const [nx, ny, nz] = volume.size;
  const [x0, y0, z0] = [place[0] * CUBE, place[1] * CUBE, place[2] * CUBE];
  const width = Math.min(CUBE, nx - x0);
  for (let z = z0; z < Math.min(z0 + CUBE, nz); ++z)
    for (let y = y0; y < Math.min(y0 + CUBE, ny); ++y) {
      const from = ((z - z0) * CUBE + (y - y0)) * CUBE;
      volume.labels.set(cube.subarray(from, from + width), (z * ny + y) * nx + x0);
    }
}

export async function decompress(gzip: ArrayBuffer, wide: boolean): Promise<Uint8Array | Uint16Array> {
  const stream = new Blob([gzip]).stream().pipeThrough(new DecompressionStream("gzip"));
  const bytes = await new Response(stream).arrayBuffer();
  const expected = CUBE ** 3 * (wide ? 2 : 1);
  if (bytes.byteLength !== expected) throw new Error(`a cube of cells has ${bytes.byteLength} bytes, expected ${expected}`);
  return wide ? new Uint16Array(bytes) : new Uint8Array(bytes); // little-endian, like every machine that runs a browser
}
