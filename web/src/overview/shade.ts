// What makes a surface look smooth and solid: a normal per vertex, and how much of the sky the vertex sees. The worker
// computes both once.
import type { Volume } from "./volume";

// The mean of the normals of the triangles around each vertex, weighted by their areas. A vertex whose triangles have
// no area keeps (0, 0, 0).
export function normals_of(positions: Float32Array, indices: Uint32Array): Float32Array {
  const normals = new Float32Array(positions.length);
  for (let t = 0; t < indices.length; t += 3) {
    const [a, b, c] = [3 * indices[t]!, 3 * indices[t + 1]!, 3 * indices[t + 2]!];
    const [ux, uy, uz] = [positions[b]! - positions[a]!, positions[b + 1]! - positions[a + 1]!, positions[b + 2]! - positions[a + 2]!];
    const [vx, vy, vz] = [positions[c]! - positions[a]!, positions[c + 1]! - positions[a + 1]!, positions[c + 2]! - positions[a + 2]!];
    const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const v of [a, b, c]) {
      normals[v] = normals[v]! + nx;
      normals[v + 1] = normals[v + 1]! + ny;
      normals[v + 2] = normals[v + 2]! + nz;
    }
  }
  for (let v = 0; v < normals.length; v += 3) {
    const length = Math.hypot(normals[v]!, normals[v + 1]!, normals[v + 2]!);
    if (length === 0) continue;
    for (let d = 0; d < 3; ++d) normals[v + d] = normals[v + d]! / length;
  }
  return normals;
}

// A coarse picture of where a material is: its share of each block of `block`^3 cells, blurred along each axis.
export interface Density {
  readonly block: number;
  readonly size: readonly [number, number, number];
  readonly share: Float32Array;
}

export function density_of(volume: Volume, material: number, block: number): Density {
  const [nx, ny, nz] = volume.size;
  // An empty block lies all around: what is outside is open sky.
  const size = [Math.ceil(nx / block) + 2, Math.ceil(ny / block) + 2, Math.ceil(nz / block) + 2] as [number, number, number];
  let share = new Float32Array(size[0] * size[1] * size[2]);
  const one = 1 / block ** 3;
  for (let z = 0, at = 0; z < nz; ++z)
    for (let y = 0; y < ny; ++y) {
      const row = ((Math.floor(z / block) + 1) * size[1] + Math.floor(y / block) + 1) * size[0] + 1;
      for (let x = 0; x < nx; ++x, ++at) {
        if (volume.labels[at] !== material) continue;
        const b = row + Math.floor(x / block);
        share[b] = share[b]! + one;
      }
    }
  const stride = [1, size[0], size[0] * size[1]];
  for (let d = 0; d < 3; ++d) {
    const next = new Float32Array(share.length);
    const step = stride[d]!;
    for (let i = 0; i < share.length; ++i) {
      const place = Math.floor(i / step) % size[d]!;
      const before = place > 0 ? share[i - step]! : 0;
      const after = place + 1 < size[d]! ? share[i + step]! : 0;
      next[i] = (before + 2 * share[i]! + after) / 4;
    }
    share = next;
  }
  return { block, size, share };
}

function share_at({ block, size, share }: Density, p: readonly [number, number, number]): number {
  const low: number[] = [];
  const rest: number[] = [];
  for (let d = 0; d < 3; ++d) {
    const t = Math.min(Math.max(p[d]! / block + 0.5, 0), size[d]! - 1.001); // block 1 has its middle at block / 2
    low.push(Math.floor(t));
    rest.push(t - Math.floor(t));
  }
  let sum = 0;
  for (let corner = 0; corner < 8; ++corner) {
    const [i, j, k] = [corner & 1, (corner >> 1) & 1, corner >> 2];
    const weight = (i ? rest[0]! : 1 - rest[0]!) * (j ? rest[1]! : 1 - rest[1]!) * (k ? rest[2]! : 1 - rest[2]!);
    sum += weight * share[((low[2]! + k) * size[1] + low[1]! + j) * size[0] + low[0]! + i]!;
  }
  return sum;
}

// How open the space in front of a vertex is, from 0 to 1: about 0.8 on a plane, more on edges, less in grooves. The
// vertex is in cells.
export function openness(density: Density, x: number, y: number, z: number, nx: number, ny: number, nz: number): number {
  let shut = 0;
  for (const reach of [0.7, 1.8]) {
    const far = reach * density.block;
    shut += share_at(density, [x + nx * far, y + ny * far, z + nz * far]);
  }
  return Math.min(Math.max(1 - 0.75 * shut, 0), 1);
}
