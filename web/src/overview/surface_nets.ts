// Makes a closed surface for each material from the labels of cells, by surface nets (S. Gibson, "Constrained elastic
// surface nets", 1998; without an isovalue as in M. Lysenko, "Smooth voxel terrain", 2012).
//
// The net's vertices are the corners of cells at which labels meet, and its faces are the faces between cells of
// different labels. Relaxing pulls each vertex to the mean of its neighbours, but never far from its anchor: the net
// becomes smooth and keeps its topology. All materials share the vertices, so touching bodies fit together exactly.
// Cells outside count as label 0, which gets no surface; vertices on the border stay in its plane. All lengths are in
// cells: a vertex at 2.5 lies in the middle of cell 2.
//
// A coarse cell has the strongest label that occurs anywhere in it. So on average the surface runs through the middle
// of the outermost cells of the stronger material. Anchors are moved there from the corners, but less where that
// material is one cell thick, because sheets and wires must not vanish.
import type { Volume } from "./volume";

export interface Net {
  readonly corners: Uint32Array; // three per vertex
  readonly anchors: Float32Array;
  readonly bounds: Float32Array; // how far a vertex may go from its anchor along each axis; 0 on the border
  readonly links: Int32Array; // six per vertex: the neighbours along -x, x, -y, y, -z, z; -1 for none
  readonly positions: Float32Array;
}

export interface Faces {
  readonly material: number;
  readonly vertices: Uint32Array; // of the net, in the order of their first use
  readonly indices: Uint32Array; // triangles, of `vertices`, anticlockwise seen from outside
}

// The number of quads of each material, by its number: a cheap way to know beforehand what a surface will cost.
export function count_quads(volume: Volume): Map<number, number> {
  const counts = new Map<number, number>();
  for_each_face(volume, (inside) => counts.set(inside, (counts.get(inside) ?? 0) + 1));
  return counts;
}

// Calls `face` for every face of a material, with the material, the axis, the direction outward (1 or -1), and the
// lowest corner.
function for_each_face(volume: Volume, face: (material: number, axis: number, outward: number, x: number, y: number, z: number) => void): void {
  const { labels, size } = volume;
  const [nx, ny, nz] = size;
  const between = (before: number, here: number, axis: number, x: number, y: number, z: number) => {
    if (before === here) return;
    if (before !== 0) face(before, axis, 1, x, y, z);
    if (here !== 0) face(here, axis, -1, x, y, z);
  };
  let at = 0;
  for (let z = 0; z < nz; ++z)
    for (let y = 0; y < ny; ++y)
      for (let x = 0; x < nx; ++x, ++at) {
        const here = labels[at]!;
        between(x > 0 ? labels[at - 1]! : 0, here, 0, x, y, z);
        between(y > 0 ? labels[at - nx]! : 0, here, 1, x, y, z);
        between(z > 0 ? labels[at - nx * ny]! : 0, here, 2, x, y, z);
        if (x + 1 === nx) between(here, 0, 0, nx, y, z);
        if (y + 1 === ny) between(here, 0, 1, x, ny, z);
        if (z + 1 === nz) between(here, 0, 2, x, y, nz);
      }
}

export interface NetOptions {
  readonly strength: (label: number) => number; // the label with the larger strength wins in a coarse cell
  readonly inward: number; // cells from the corner to the expected surface: 0 at level 0, nearly 1/2 on the coarsest levels
}

// The cells of the block with a border of label 0 around them, so that every corner has eight cells.
function bordered({ labels, size }: Volume): { labels: Uint16Array; stride: readonly [number, number, number] } {
  const [nx, ny, nz] = size;
  const stride = [1, nx + 2, (nx + 2) * (ny + 2)] as const;
  const out = new Uint16Array(stride[2] * (nz + 2));
  for (let z = 0; z < nz; ++z)
    for (let y = 0; y < ny; ++y) out.set(labels.subarray((z * ny + y) * nx, (z * ny + y + 1) * nx), 1 + (y + 1) * stride[1] + (z + 1) * stride[2]);
  return { labels: out, stride };
}

// The vertices and their neighbours. Positions are the anchors at first.
export function make_net(volume: Volume, { strength, inward }: NetOptions): { net: Net; vertex_at: Int32Array } {
  const { size } = volume;
  const [cx, cy, cz] = [size[0] + 1, size[1] + 1, size[2] + 1];
  const { labels, stride } = bordered(volume);
  const around = Array.from({ length: 8 }, (_, i) => (i & 1) * stride[0] + ((i >> 1) & 1) * stride[1] + (i >> 2) * stride[2]);
  const step = [1, cx, cx * cy];
  const vertex_at = new Int32Array(cx * cy * cz).fill(-1);
  const corners: number[] = [];
  const edges: number[] = []; // the lower end's corner times 3, plus the axis
  const add = (at: number, x: number, y: number, z: number) => {
    if (vertex_at[at]! >= 0) return;
    vertex_at[at] = corners.length / 3;
    corners.push(x, y, z);
  };
  for (let z = 0, at = 0; z < cz; ++z)
    for (let y = 0; y < cy; ++y)
      for (let x = 0, c = y * stride[1] + z * stride[2]; x < cx; ++x, ++at, ++c) {
        // The cells around the corner, the last of which begins at it.
        const cell = labels[c + around[7]!]!;
        const [yz, xz, xy] = [labels[c + around[1]!]!, labels[c + around[2]!]!, labels[c + around[4]!]!]; // the cells before it along two axes
        const [zm, ym, xm] = [labels[c + around[3]!]!, labels[c + around[5]!]!, labels[c + around[6]!]!]; // and those along one
        // An edge of the lattice belongs to the surface when the four cells around it are not all alike. Then its ends
        // belong to it as well.
        if (x + 1 < cx && (cell !== ym || cell !== zm || cell !== yz)) {
          edges.push(3 * at);
          add(at, x, y, z);
          add(at + step[0]!, x + 1, y, z);
        }
        if (y + 1 < cy && (cell !== xm || cell !== zm || cell !== xz)) {
          edges.push(3 * at + 1);
          add(at, x, y, z);
          add(at + step[1]!, x, y + 1, z);
        }
        if (z + 1 < cz && (cell !== xm || cell !== ym || cell !== xy)) {
          edges.push(3 * at + 2);
          add(at, x, y, z);
          add(at + step[2]!, x, y, z + 1);
        }
      }

  const count = corners.length / 3;
  const links = new Int32Array(6 * count).fill(-1);
  for (const edge of edges) {
    const d = edge % 3;
    const at = (edge - d) / 3;
    const [a, b] = [vertex_at[at]!, vertex_at[at + step[d]!]!];
    links[6 * a + 2 * d + 1] = b;
    links[6 * b + 2 * d] = a;
  }

  const anchors = Float32Array.from(corners);
  const bounds = new Float32Array(3 * count);
  const shift = [0, 0, 0];
  const thin = [false, false, false];
  for (let v = 0; v < count; ++v) {
    const c = corners[3 * v]! + corners[3 * v + 1]! * stride[1] + corners[3 * v + 2]! * stride[2];
    let strongest = 0;
    for (const offset of around) {
      const label = labels[c + offset]!;
      if (label !== 0 && (strongest === 0 || strength(label) > strength(strongest))) strongest = label;
    }
    let cells = 0;
    shift.fill(0);
    thin.fill(false);
    for (let i = 0; i < 8; ++i) {
      const cell = c + around[i]!;
      if (labels[cell] !== strongest) continue;
      ++cells;
      for (let d = 0; d < 3; ++d) {
        shift[d]! += (i >> d) & 1 ? 1 : -1;
        thin[d] ||= labels[cell - stride[d]!] !== strongest && labels[cell + stride[d]!] !== strongest;
      }
    }
    const wire = Number(thin[0]) + Number(thin[1]) + Number(thin[2]) > 1;
    for (let d = 0; d < 3; ++d) {
      const corner = corners[3 * v + d]!;
      if (corner === 0 || corner === size[d]) continue;
      anchors[3 * v + d] = corner + (shift[d]! / cells) * inward * (wire ? 0.2 : thin[d] ? 0.4 : 1);
      bounds[3 * v + d] = wire ? 0.15 : thin[d] ? 0.3 : 0.5;
    }
  }
  return { net: { corners: Uint32Array.from(corners), anchors, bounds, links, positions: anchors.slice() }, vertex_at };
}

// Moves every vertex to the mean of its neighbours, within its bounds, `rounds` times.
export function relax(net: Net, rounds: number): void {
  const { anchors, bounds, links, positions } = net;
  const vertices = anchors.length / 3;
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
      const at = 3 * v;
      next[at] = within(x / n, anchors[at]!, bounds[at]!);
      next[at + 1] = within(y / n, anchors[at + 1]!, bounds[at + 1]!);
      next[at + 2] = within(z / n, anchors[at + 2]!, bounds[at + 2]!);
    }
    positions.set(next);
  }
}

const within = (x: number, anchor: number, bound: number) => Math.min(Math.max(x, anchor - bound), anchor + bound);

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
  const distance = (a: number, b: number) =>
    (p[3 * a]! - p[3 * b]!) ** 2 + (p[3 * a + 1]! - p[3 * b + 1]!) ** 2 + (p[3 * a + 2]! - p[3 * b + 2]!) ** 2;
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
