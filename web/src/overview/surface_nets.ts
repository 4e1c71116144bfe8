// Labels of cells -> a closed surface for each material: surface nets (S. Gibson, "Constrained elastic surface nets", 1998; without an
// isovalue as in M. Lysenko, "Smooth voxel terrain", 2012).
//
// The net's vertices are the corners of cells at which labels meet, and its faces are the faces between cells of different labels.
// Relaxing pulls each vertex to the mean of its neighbours, never farther from its corner than a bound: the net becomes smooth, and
// keeps its topology. All materials share the vertices, so touching bodies fit together exactly. Cells outside count as label 0, which
// gets no surface; vertices on the border stay in its plane. Everything is in cells: a vertex at 2.5 lies in the middle of cell 2.
import type { Volume } from "./volume";

export interface Net {
  readonly corners: Uint32Array; // three a vertex
  readonly links: Int32Array; // six a vertex: the neighbours along -x, x, -y, y, -z, z; -1 for none
  readonly positions: Float32Array;
}

export interface Faces {
  readonly material: number;
  readonly vertices: Uint32Array; // of the net, in the order of their first use
  readonly indices: Uint32Array; // triangles, of `vertices`, anticlockwise seen from outside
}

// The quads of each material, by its number: a cheap way to know beforehand what a surface will cost.
export function count_quads(volume: Volume): Map<number, number> {
  const counts = new Map<number, number>();
  for_each_face(volume, (inside) => counts.set(inside, (counts.get(inside) ?? 0) + 1));
  return counts;
}

// Calls with the material, the axis, the direction outward (1 or -1), and the lowest corner of every face of a material.
function for_each_face(volume: Volume, face: (material: number, axis: number, outward: number, x: number, y: number, z: number) => void): void {
  const { labels, size } = volume;
  const [nx, ny, nz] = size;
  const stride = [1, nx, nx * ny];
  let at = 0;
  for (let z = 0; z < nz; ++z)
    for (let y = 0; y < ny; ++y)
      for (let x = 0; x < nx; ++x, ++at) {
        const here = labels[at]!;
        const place = [x, y, z];
        for (let d = 0; d < 3; ++d) {
          const before = place[d]! > 0 ? labels[at - stride[d]!]! : 0;
          if (before !== here) {
            if (here !== 0) face(here, d, -1, x, y, z);
            if (before !== 0) face(before, d, 1, x, y, z);
          }
          if (here !== 0 && place[d]! + 1 === size[d]!) face(here, d, 1, x + Number(d === 0), y + Number(d === 1), z + Number(d === 2));
        }
      }
}

// The vertices and their neighbours; positions are the corners.
export function make_net(volume: Volume): { net: Net; vertex_at: Int32Array } {
  const { labels, size } = volume;
  const [nx, ny, nz] = size;
  const [cx, cy, cz] = [nx + 1, ny + 1, nz + 1];
  const label = (x: number, y: number, z: number) => (x < 0 || y < 0 || z < 0 || x >= nx || y >= ny || z >= nz ? 0 : labels[(z * ny + y) * nx + x]!);
  const vertex_at = new Int32Array(cx * cy * cz).fill(-1);
  const stride = [1, cx, cx * cy];
  let count = 0;
  // An edge of the lattice belongs to the surface when the four cells around it differ; then so do its ends.
  const edges: number[][] = [[], [], []];
  for (let z = 0, at = 0; z < cz; ++z)
    for (let y = 0; y < cy; ++y)
      for (let x = 0; x < cx; ++x, ++at) {
        const a = label(x, y, z);
        const xm = label(x - 1, y, z);
        const ym = label(x, y - 1, z);
        const zm = label(x, y, z - 1);
        const xy = label(x - 1, y - 1, z);
        const xz = label(x - 1, y, z - 1);
        const yz = label(x, y - 1, z - 1);
        const along = [x < nx && (a !== ym || a !== zm || a !== yz), y < ny && (a !== xm || a !== zm || a !== xz), z < nz && (a !== xm || a !== ym || a !== xy)];
        for (let d = 0; d < 3; ++d) {
          if (!along[d]) continue;
          edges[d]!.push(at);
          if (vertex_at[at]! < 0) vertex_at[at] = count++;
          const end = at + stride[d]!;
          if (vertex_at[end]! < 0) vertex_at[end] = count++;
        }
      }
  const corners = new Uint32Array(3 * count);
  for (let z = 0, at = 0; z < cz; ++z)
    for (let y = 0; y < cy; ++y)
      for (let x = 0; x < cx; ++x, ++at) if (vertex_at[at]! >= 0) corners.set([x, y, z], 3 * vertex_at[at]!);
  const links = new Int32Array(6 * count).fill(-1);
  for (let d = 0; d < 3; ++d)
    for (const at of edges[d]!) {
      const [a, b] = [vertex_at[at]!, vertex_at[at + stride[d]!]!];
      links[6 * a + 2 * d + 1] = b;
      links[6 * b + 2 * d] = a;
    }
  return { net: { corners, links, positions: Float32Array.from(corners) }, vertex_at };
}

// `rounds` times: every vertex goes to the mean of its neighbours, within `bound` cells of its corner along each axis.
export function relax(net: Net, size: readonly number[], rounds: number, bound: number): void {
  const { corners, links, positions } = net;
  const vertices = corners.length / 3;
  const next = new Float32Array(positions.length);
  for (let round = 0; round < rounds; ++round) {
    for (let v = 0; v < vertices; ++v) {
      let [x, y, z, n] = [0, 0, 0, 0];
      for (let l = 6 * v; l < 6 * v + 6; ++l) {
        const other = 3 * links[l]!;
        if (other < 0) continue;
        x += positions[other]!;
        y += positions[other + 1]!;
        z += positions[other + 2]!;
        ++n;
      }
      const mean = [x / n, y / n, z / n];
      for (let d = 0; d < 3; ++d) {
        const corner = corners[3 * v + d]!;
        const free = corner === 0 || corner === size[d]! ? 0 : bound;
        next[3 * v + d] = Math.min(Math.max(mean[d]!, corner - free), corner + free);
      }
    }
    positions.set(next);
  }
}

// The triangles of every material. Each face is cut along its shorter diagonal, the same for the materials on both its sides.
export function faces_of(volume: Volume, net: Net, vertex_at: Int32Array): Faces[] {
  const counts = count_quads(volume);
  const quads = new Map<number, { corners: Uint32Array; length: number }>();
  for (const [material, count] of counts) quads.set(material, { corners: new Uint32Array(4 * count), length: 0 });
  const [cx, cy] = [volume.size[0] + 1, volume.size[1] + 1];
  const stride = [1, cx, cx * cy];
  for_each_face(volume, (material, d, outward, x, y, z) => {
    const at = x + cx * (y + cy * z);
    // u, v and the axis are a right-handed system: anticlockwise seen from its upper end.
    const [u, v] = [stride[(d + 1) % 3]!, stride[(d + 2) % 3]!];
    const list = quads.get(material)!;
    const ring = outward > 0 ? [at, at + u, at + u + v, at + v] : [at, at + v, at + u + v, at + u];
    for (const corner of ring) list.corners[list.length++] = vertex_at[corner]!;
  });
  const p = net.positions;
  const distance = (a: number, b: number) => (p[3 * a]! - p[3 * b]!) ** 2 + (p[3 * a + 1]! - p[3 * b + 1]!) ** 2 + (p[3 * a + 2]! - p[3 * b + 2]!) ** 2;
  const local = new Int32Array(net.corners.length / 3).fill(-1);
  return [...quads].map(([material, { corners }]) => {
    const used: number[] = [];
    const number = (vertex: number) => {
      if (local[vertex]! < 0) {
        local[vertex] = used.length;
        used.push(vertex);
      }
      return local[vertex]!;
    };
    const indices = new Uint32Array((corners.length / 4) * 6);
    for (let q = 0, at = 0; q < corners.length; q += 4) {
      const [a, b, c, d] = [corners[q]!, corners[q + 1]!, corners[q + 2]!, corners[q + 3]!];
      const split = distance(a, c) <= distance(b, d) ? [a, b, c, a, c, d] : [a, b, d, b, c, d];
      for (const vertex of split) indices[at++] = number(vertex);
    }
    for (const vertex of used) local[vertex] = -1;
    return { material, vertices: Uint32Array.from(used), indices };
  });
}
