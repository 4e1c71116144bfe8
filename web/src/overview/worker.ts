// The overview's worker: cubes of labels in, surfaces of all materials out, ready for the graphics card. It keeps nothing.
import type { Index3 } from "../api";
import { coordinate_at } from "./level_axis";
import { density_of, normals_of, openness } from "./shade";
import { count_quads, faces_of, make_net, relax } from "./surface_nets";
import { type Cube, decompress, empty_volume, place_cube } from "./volume";

export interface SurfaceJob {
  readonly size: Index3; // cells of the level
  readonly wide: boolean; // labels of two bytes
  readonly planes: readonly Float64Array[]; // between the cells of each axis, in the overview's space
  readonly cubes: readonly Cube[];
  readonly most_triangles: number;
}

export interface Surface {
  readonly material: number;
  readonly positions: Float32Array; // in the overview's space
  readonly shades: Int16Array; // four a vertex: the normal, and how open the place is; 32767 is 1
  readonly indices: Uint32Array;
}

export type SurfaceAnswer = { surfaces: Surface[] } | { too_many: number } | { failed: string };

// Positions stay near their corners, so that a rod one cell thick stays a rod. Normals come from a net that may relax farther.
const POSITIONS = { rounds: 12, bound: 0.3 };
const NORMALS = { rounds: 14, bound: 0.5 };
const MOST_DENSITIES = 24; // beyond that many materials the others look equally open everywhere

async function surfaces_of(job: SurfaceJob): Promise<SurfaceAnswer> {
  const volume = empty_volume(job.size, job.wide);
  for (const cube of job.cubes) place_cube(volume, cube.place, await decompress(cube.bytes, job.wide));
  const triangles = 2 * [...count_quads(volume).values()].reduce((sum, n) => sum + n, 0);
  if (triangles > job.most_triangles) return { too_many: triangles };

  const { net, vertex_at } = make_net(volume);
  relax(net, job.size, POSITIONS.rounds, POSITIONS.bound);
  const cells = net.positions.slice();
  const faces = faces_of(volume, net, vertex_at);
  relax(net, job.size, NORMALS.rounds, NORMALS.bound);
  const place = (source: Float32Array, vertices: Uint32Array) => {
    const out = new Float32Array(3 * vertices.length);
    for (let i = 0; i < vertices.length; ++i) for (let d = 0; d < 3; ++d) out[3 * i + d] = coordinate_at(job.planes[d]!, source[3 * vertices[i]! + d]!);
    return out;
  };
  const block = Math.max(2, Math.round(Math.max(...job.size) / 40));
  faces.sort((a, b) => b.indices.length - a.indices.length);
  const surfaces = faces.map(({ material, vertices, indices }, rank): Surface => {
    const positions = place(cells, vertices);
    const own = normals_of(positions, indices);
    const smooth = normals_of(place(net.positions, vertices), indices);
    const density = rank < MOST_DENSITIES ? density_of(volume, material, block) : null;
    const shades = new Int16Array(4 * vertices.length);
    for (let i = 0; i < vertices.length; ++i) {
      const flat = smooth[3 * i] === 0 && smooth[3 * i + 1] === 0 && smooth[3 * i + 2] === 0;
      const [nx, ny, nz] = (flat ? own : smooth).subarray(3 * i, 3 * i + 3) as unknown as [number, number, number];
      const v = 3 * vertices[i]!;
      const open = density ? openness(density, cells[v]!, cells[v + 1]!, cells[v + 2]!, nx, ny, nz) : 0.8;
      shades.set([nx * 32767, ny * 32767, nz * 32767, open * 32767], 4 * i);
    }
    return { material, positions, shades, indices };
  });
  return { surfaces };
}

self.onmessage = async (event: MessageEvent<SurfaceJob>) => {
  let answer: SurfaceAnswer;
  try {
    answer = await surfaces_of(event.data);
  } catch (error) {
    answer = { failed: error instanceof Error ? error.message : String(error) };
  }
  const buffers = "surfaces" in answer ? answer.surfaces.flatMap((s) => [s.positions.buffer, s.shades.buffer, s.indices.buffer]) : [];
  self.postMessage(answer, { transfer: buffers as ArrayBuffer[] });
};
