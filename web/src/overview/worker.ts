// The overview's worker. It takes cubes of labels and returns the surfaces of all materials, ready for the graphics
// card. It keeps nothing between two jobs.
import type { Index3 } from "../base/grid";
import { coordinate_at } from "./level_axis";
import { density_of, normals_of, openness } from "./shade";
import { count_quads, faces_of, make_net, relax } from "./surface_nets";
import { type Cube, decompress, empty_volume, place_cube } from "./volume";

export interface SurfaceJob {
  readonly size: Index3; // cells of the level
  readonly level: number;
  readonly ranks: readonly number[]; // of the materials: the strongest one has the lowest
  readonly wide: boolean; // labels of two bytes
  readonly planes: readonly Float64Array[]; // between the cells of each axis, in the overview's space
  readonly cubes: readonly Cube[];
  readonly most_triangles: number;
}

export interface Surface {
  readonly material: number;
  readonly positions: Float32Array; // in the overview's space
  readonly shades: Int16Array; // four per vertex: the normal, and how open the place is; 32767 stands for 1
  readonly indices: Uint32Array;
}

export type SurfaceAnswer = { surfaces: Surface[] } | { too_many: number } | { failed: string };

// More rounds make gentle slopes smoother, and small balls smaller. After these, the normals of a sphere with a radius
// of 20 cells are right to 2 degrees.
const ROUNDS = 8;
const MOST_DENSITIES = 24; // with more materials, the smallest ones look equally open everywhere

async function surfaces_of(job: SurfaceJob): Promise<SurfaceAnswer> {
  const volume = empty_volume(job.size, job.wide);
  for (const cube of job.cubes) place_cube(volume, cube.place, await decompress(cube.bytes, job.wide));
  const triangles = 2 * [...count_quads(volume).values()].reduce((sum, n) => sum + n, 0);
  if (triangles > job.most_triangles) return { too_many: triangles };

  const { net, vertex_at } = make_net(volume, { strength: (label) => -job.ranks[label]!, inward: (1 - 2 ** -job.level) / 2 });
  relax(net, ROUNDS);
  const faces = faces_of(volume, net, vertex_at).sort((a, b) => b.indices.length - a.indices.length);
  const block = Math.max(2, Math.round(Math.max(...job.size) / 40));
  const surfaces = faces.map(({ material, vertices, indices }, rank): Surface => {
    const positions = new Float32Array(3 * vertices.length);
    for (let i = 0; i < vertices.length; ++i)
      for (let d = 0; d < 3; ++d) positions[3 * i + d] = coordinate_at(job.planes[d]!, net.positions[3 * vertices[i]! + d]!);
    const normals = normals_of(positions, indices);
    const density = rank < MOST_DENSITIES ? density_of(volume, material, block) : null;
    const shades = new Int16Array(4 * vertices.length);
    for (let i = 0; i < vertices.length; ++i) {
      const [nx, ny, nz] = [normals[3 * i]!, normals[3 * i + 1]!, normals[3 * i + 2]!];
      const v = 3 * vertices[i]!;
      const open = density ? openness(density, net.positions[v]!, net.positions[v + 1]!, net.positions[v + 2]!, nx, ny, nz) : 0.8;
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
