// The overview's space. Its origin is the middle of the domain, and the domain's longest side is 2, so that single
// precision suffices for any coordinates. Graded axes are true to scale.
import type { Axis } from "../../base/axis";
import { for_axes } from "../../base/grid";
import type { Range } from "../../state/zoom";

export type Axes = readonly [Axis, Axis, Axis];
export type Vec3 = [number, number, number];

export interface Space {
  readonly middle: Readonly<Vec3>;
  readonly scale: number;
  readonly half: Readonly<Vec3>; // the domain is -half to half
}

// `domain`: along each axis.
export function space_of(domain: readonly [Range, Range, Range]): Space {
  const extent = domain.map((a) => a.max - a.min);
  const scale = 2 / Math.max(...extent, Number.MIN_VALUE);
  return {
    middle: domain.map((a) => (a.min + a.max) / 2) as Vec3,
    scale,
    half: extent.map((e) => (e * scale) / 2) as Vec3,
  };
}

export const to_space = (space: Space, d: number, coordinate: number): number => (coordinate - space.middle[d]!) * space.scale;
export const from_space = (space: Space, d: number, x: number): number => x / space.scale + space.middle[d]!;
export const point_to_space = (space: Space, p: readonly number[]): Vec3 => for_axes((d) => to_space(space, d, p[d]!));

// The shortest side of a cell, in the overview's space.
export const shortest_side = (space: Space, axes: Axes): number => space.scale * Math.min(...axes.map((axis) => axis.finest));
