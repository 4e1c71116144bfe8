// Where the cells of a pyramid level lie in the overview's space. Its origin is the middle of the domain, and the
// domain's longest side is 2, so that single precision suffices for any coordinates. Graded axes are true to scale. The
// last cell of a coarse level ends with its axis.
import type { Axis } from "../base/axis";
import type { Index3 } from "../base/grid";

export type Axes = readonly [Axis, Axis, Axis];
export type Vec3 = [number, number, number];

export interface Space {
  readonly middle: Readonly<Vec3>;
  readonly scale: number;
  readonly half: Readonly<Vec3>; // the domain is -half to half
}

export function space_of(axes: Axes): Space {
  const extent = axes.map((a) => a.max - a.min);
  const scale = 2 / Math.max(...extent, Number.MIN_VALUE);
  return {
    middle: axes.map((a) => (a.min + a.max) / 2) as Vec3,
    scale,
    half: extent.map((e) => (e * scale) / 2) as Vec3,
  };
}

export const to_space = (space: Space, d: number, coordinate: number): number => (coordinate - space.middle[d]!) * space.scale;
export const from_space = (space: Space, d: number, x: number): number => x / space.scale + space.middle[d]!;
export const point_to_space = (space: Space, p: readonly number[]): Vec3 => [
  to_space(space, 0, p[0]!),
  to_space(space, 1, p[1]!),
  to_space(space, 2, p[2]!),
];

// The planes between the cells of a level.
export function level_planes(axis: Axis, level: number): Float64Array {
  const wide = 2 ** level;
  const planes = new Float64Array(Math.ceil(axis.cells / wide) + 1);
  for (let i = 0; i < planes.length; ++i) planes[i] = axis.plane(Math.min(i * wide, axis.cells));
  return planes;
}

// The coordinate of a place that is counted in cells: 2.5 is the middle of cell 2.
export function coordinate_at(planes: Float64Array, t: number): number {
  const i = Math.min(Math.max(Math.floor(t), 0), planes.length - 2);
  return planes[i]! + (t - i) * (planes[i + 1]! - planes[i]!);
}

export const cells_of_level = (cells: Index3, level: number): Index3 => cells.map((n) => Math.ceil(n / 2 ** level)) as Index3;

// The finest level with at most this many cells along each side.
export function level_within(cells: readonly number[], most: number, levels: number): number {
  let level = 0;
  while (level + 1 < levels && cells.some((n) => Math.ceil(n / 2 ** level) > most)) ++level;
  return level;
}
