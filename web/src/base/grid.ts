// The types of what the server says about grids, and the addresses of one grid. Addresses are relative to the page,
// which may be served below any path.
import { ranges } from "./ranges";

export type Index3 = [number, number, number];
export type AxisIndex = 0 | 1 | 2;
export const AXES: readonly AxisIndex[] = [0, 1, 2];
export const AXIS_NAMES = ["x", "y", "z"] as const;
export const for_axes = <T>(make: (d: AxisIndex) => T): [T, T, T] => [make(0), make(1), make(2)];

export type AxisJson = { type: "uniform"; min: number; step: number; first: number; cells: number } | { type: "graded"; planes: number[] };

export interface Material {
  id: number;
  name: string;
  color: string; // #rrggbb or #rrggbbaa
  rank: number; // where one of several materials is needed, the lowest rank wins
}

// What a label stands for: a material or, where the file keeps bodies apart, a body. The background has no body.
export interface Label {
  material: number;
  body: string;
  overlap?: true; // of the body's cells that lie in other bodies as well; the label before it is that of its other cells
}

// What a label is where it does not matter whether cells lie in other bodies as well.
export const without_overlap = (labels: readonly Label[], label: number): number => (labels[label]?.overlap ? label - 1 : label);

export interface Hole {
  at: [number, number, number];
  edges: number;
  diameter: number;
  diameter_cells?: number;
  width?: number; // of its gap: much less than the diameter when it is a crack
  width_cells?: number;
  cap_area: number;
  extruded?: boolean; // closed by walls and a floor, not by a cap
}

// A curve of edges along which facets face the opposite way from their neighbours.
export interface Flip {
  at: [number, number, number];
  edges: number;
}

export interface BodyReport {
  name: string;
  facets: number;
  degenerate: number;
  duplicates: number;
  opposite?: number; // duplicates whose orientation is opposite to that of the first of them
  shells: number;
  seams?: { number: number; length: number; widest_gap: number };
  fill: { rule: string; shells: number; why: string }[];
  holes: Hole[];
  flips: Flip[];
  cells: number;
  cells_text?: string; // the exact count, when it is above 2^53
  covered_cells?: number; // inside the body, but owned by stronger bodies
}

// The scene as it was meshed, as far as the page asks for it.
export interface SceneReport {
  bodies: { name: string; material: string; matrix: number[] }[]; // of a matrix the upper three rows, one after another
}

// What two bodies have in common.
export interface OverlapReport {
  bodies: [string, string];
  cells: number;
  cells_text?: string;
  owner: string | null; // of all of these cells, if it is one of the two
  box: [number, number, number, number, number, number];
  at: [number, number, number];
}

export interface Report {
  bodies: BodyReport[];
  crossings: number;
  warnings: string[];
  inputs: { path: string; format: string; bytes: number; hash: string }[]; // one for each body
  scene?: SceneReport | null; // null where there was no room for it
  overlaps?: { pairs: number; list: OverlapReport[] };
  ray_axis?: { axis: string; why: string; crossings_expected?: number[] };
}

export interface GridInfo {
  id: string;
  units: string;
  to_file?: number; // by what coordinates are multiplied to be those of the file, where they are shown in another unit
  ray_axis: string;
  grid: { min: number[]; max: number[]; cells: Index3; sample: number[]; axes: AxisJson[]; cells_text: string };
  materials: Material[];
  labels?: Label[]; // where the file keeps bodies apart; otherwise labels are materials
  levels: { level: number; cells: Index3; stored: boolean; chunks: number; bytes: number }[];
  channels: { name: string; coding: string; bytes: number }[]; // what the file holds beside the cells
  file: { bytes: number; version: string; hash: string };
  crossings: number;
  bits_per_crossing: number;
  report: Report;
}

export interface GridSummary {
  id: string;
  name: string;
  cells: Index3;
  bytes: number;
  hash: string;
  units: string;
  modified: number | null; // seconds since 1970; null for a grid behind an address
  checked: boolean; // whether what `teracell check` has found is there
  damage: string | null; // what answers have met first that can't be read
  protocols: { title: string; path: string }[]; // the addresses for other programs, below the server's base path
}

// A file in the served folder that cannot be read as a grid, and why.
export interface UnreadableFile {
  id: string;
  error: string;
}

// Cells of a material or a body.
export interface Amount {
  cells: number;
  cells_text?: string; // the exact count, when it is above 2^53
  volume: number;
  box: [number, number, number, number, number, number] | null;
}
export interface MaterialStats extends Amount {
  id: number;
  name: string;
}
export interface BodyStats extends Amount {
  label: number;
  name: string; // of the body; empty for the background
  material: number;
  overlap?: true; // as of a label
}
export interface Stats {
  region: [number, number, number, number, number, number];
  materials: MaterialStats[];
  bodies?: BodyStats[]; // where they were asked for
}
// A cell of level 0.
export interface CellAnswer {
  materials: { id: number; name: string }[];
  bodies?: { label: number; name: string; material: number }[]; // where the file keeps bodies apart
  shares?: Share[]; // where the file has fractions
  plane?: Plane; // where more than one material has a share
}
export interface Share {
  id: number;
  name: string;
  share: number; // from 0 to 1
}
// The plane that stands for the surface of a material within a cell: normal . x = offset. The material lies where normal . x is less.
export interface Plane {
  id: number;
  name: string;
  normal: [number, number, number];
  offset: number;
}

// Which cells have a material of another name in another grid of equal cells.
export interface Change {
  from: string;
  to: string;
  cells: number;
  cells_text?: string; // the exact count, when it is above 2^53
  box: [number, number, number, number, number, number];
}
export interface Difference {
  cells: number;
  cells_text?: string;
  same: number;
  same_text?: string;
  changes: Change[]; // the most cells first
}

// How a grid is refined, as `teracell export --refine M,N --want` takes it.
export interface Refinement {
  readonly coarsest: number;
  readonly layers: number;
  readonly want: string; // empty: interface=0
}
const query_of = ({ coarsest, layers, want }: Refinement) => `refine=${coarsest},${layers}${want ? `&want=${encodeURIComponent(want)}` : ""}`;
export interface LeafCount {
  total: number;
  leaves: { level: number; material: string; leaves: number }[];
}

export interface ColumnRun {
  from: number;
  to: number;
  min: number;
  max: number;
  material: number;
  name: string;
}
// The materials along a line, as lengths from its first point.
export interface LineAnswer {
  length: number;
  runs: { from: number; to: number; length: number; cells: number; material: number; name: string }[];
}
// Null: no cell has one of the labels.
export interface NearestAnswer {
  cell: Index3 | null;
  box: Amount["box"]; // of all cells that might be found
}
// How thick a material is along the normal of its surface; null: the material goes on around the point.
export interface ThicknessAnswer {
  thickness: { material: number; name: string; length: number; cells: number; normal: [number, number, number]; from: [number, number, number]; to: [number, number, number] } | null;
}
export interface Column {
  axis: string;
  at: [number, number];
  runs: ColumnRun[];
}

// The grids that an address names: its own, and perhaps that of a comparison.
export function ids_in(path: string): string[] {
  const { pathname, searchParams } = new URL(path, "http://page/");
  const [, id] = /^\/api\/v1\/grids\/([^/]+)/.exec(pathname) ?? [];
  const other = searchParams.get("with") ?? searchParams.get("against");
  return [...(id === undefined ? [] : [decodeURIComponent(id)]), ...(other === null ? [] : [other])];
}

// The addresses of one grid. Each names the version of the file, so browsers may keep the answers for ever.
export class GridAddress {
  private readonly base: string;
  private readonly bodies: string;
  constructor(
    readonly id: string,
    readonly hash: string,
    keeps_bodies = false, // then labels are bodies
  ) {
    this.base = `api/v1/grids/${encodeURIComponent(id)}`;
    this.bodies = keeps_bodies ? "&bodies=1" : "";
  }
  // The sets of labels in a tile of 512 x 512 cells. tiles/tile.ts describes the format. With `shares`, mixed cells of level 0 tell what they
  // are made of.
  tile(axis: AxisIndex, index: number, level: number, column: number, row: number, shares = false): string {
    const more = this.bodies + (shares && level === 0 ? "&shares=1" : "");
    return `${this.base}/tile/${AXIS_NAMES[axis]}/${index}/${level}/${column}_${row}.bin?sets=1${more}&v=${this.hash}`;
  }
  // A tile with what can be read of it. What can't be read has a set without members.
  damaged_tile(axis: AxisIndex, index: number, level: number, column: number, row: number): string {
    return `${this.base}/tile/${AXIS_NAMES[axis]}/${index}/${level}/${column}_${row}.bin?sets=1${this.bodies}&damage=1&v=${this.hash}`;
  }
  // What is seen from somewhere: a picture, numbers for each of its pixels, or what is at one of its points. `query` says from where.
  view(ending: "png" | "bin" | "json", query: string): string {
    return `${this.base}/view.${ending}?${query}&v=${this.hash}`;
  }
  // The cell of a box nearest to a cell that has the material `from`, and `to` in another grid.
  changed(other: string, { from, to }: Pick<Change, "from" | "to">, cell: Index3, box: readonly number[]): string {
    return `${this.base}/changed?with=${encodeURIComponent(other)}&from=${encodeURIComponent(from)}&to=${encodeURIComponent(to)}&cell=${cell.join(",")}&region=${box.join(",")}&v=${this.hash}`;
  }
  // The sets of labels that a plane meets, in the format of a tile. `query` says which plane, and what of it.
  plane(query: string): string {
    return `${this.base}/slice/plane.bin?${query}${this.bodies}&v=${this.hash}`;
  }
  // `from` and `to`: a part of its cells, half open.
  column(axis: AxisIndex, a: number, b: number, from?: number, to?: number): string {
    const part = from === undefined ? "" : `from=${from}&to=${to}&`;
    return `${this.base}/column/${AXIS_NAMES[axis]}/${a}_${b}?${part}v=${this.hash}`;
  }
  // The materials along a straight line between two points.
  line(from: readonly number[], to: readonly number[]): string {
    return `${this.base}/line?from=${from.join(",")}&to=${to.join(",")}&v=${this.hash}`;
  }
  // The box of some labels, and a cell of them near a cell, or near its middle.
  nearest(labels: readonly number[], cell?: Index3): string {
    return `${this.base}/nearest?labels=${ranges(labels)}${cell ? `&cell=${cell.join(",")}` : ""}&v=${this.hash}`;
  }
  // How thick the material of a cell is at a point of its surface.
  thickness(cell: Index3, at: readonly number[]): string {
    return `${this.base}/thickness?cell=${cell.join(",")}&at=${at.join(",")}&v=${this.hash}`;
  }
  // A file with the cells of a box.
  box(ending: "npy" | "vti" | "vtr", box: readonly number[]): string {
    return `${this.base}/box.${ending}?region=${box.join(",")}`;
  }
  // No version: the answer depends on another grid as well.
  diff(other: string): string {
    return `${this.base}/diff?with=${encodeURIComponent(other)}`;
  }
  // The level of the leaf at each cell of a tile of 512 x 512 cells: tiles/leaf_tile.ts.
  leaves(refinement: Refinement, axis: AxisIndex, index: number, level: number, column: number, row: number): string {
    return `${this.base}/leaves/${AXIS_NAMES[axis]}/${index}/${level}/${column}_${row}.bin?${query_of(refinement)}&v=${this.hash}`;
  }
  leaf_count(refinement: Refinement, region: readonly number[]): string {
    return `${this.base}/leaves.json?${query_of(refinement)}&region=${region.join(",")}&v=${this.hash}`;
  }
  stats(region: readonly number[]): string {
    return `${this.base}/stats?region=${region.join(",")}&v=${this.hash}`;
  }
  // Of the whole grid, where the file keeps bodies apart also by body.
  all_stats(): string {
    return `${this.base}/stats?${this.bodies.slice(1)}${this.bodies && "&"}v=${this.hash}`;
  }
  cell([i, j, k]: Index3): string {
    return `${this.base}/cell?i=${i}&j=${j}&k=${k}&v=${this.hash}`;
  }
}
