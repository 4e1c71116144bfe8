// The plane of the oblique view: its directions on the screen, by the same rule as the server's (server/render/plane.cpp), and angles. Pure.
import type { Axis } from "../base/axis";
import { type AxisIndex, for_axes } from "../base/grid";

export type Vec3 = readonly [number, number, number];

export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const plus = (a: Vec3, b: Vec3, times = 1): Vec3 => [a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]];
export const cross = (a: Vec3, b: Vec3): Vec3 => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const normalised = (a: Vec3): Vec3 => {
  const length = Math.hypot(...a);
  return length > 0 ? [a[0] / length, a[1] / length, a[2] / length] : a;
};

// A plane through a point, seen from where its normal points. All three directions have length 1 and are at right angles.
export interface PlaneFrame {
  readonly normal: Vec3;
  readonly right: Vec3;
  readonly up: Vec3;
  readonly through: Vec3; // coordinates
}

const STRAIGHT = 1 - 1e-12; // of a normal along z, where y is up

export function plane_frame(towards: Vec3, through: Vec3): PlaneFrame {
  const normal = normalised(towards);
  const right = normalised(cross(Math.abs(normal[2]) >= STRAIGHT ? [0, 1, 0] : [0, 0, 1], normal));
  return { normal, right, up: cross(normal, right), through };
}

// A point taken to the plane along its normal.
export const onto = (frame: PlaneFrame, point: Vec3): Vec3 => plus(point, frame.normal, dot(frame.normal, plus(frame.through, point, -1)));

// The normal from which a slice across an axis is seen, with u to the right and v up.
export const SLICE_NORMALS: readonly [Vec3, Vec3, Vec3] = [[1, 0, 0], [0, -1, 0], [0, 0, 1]];

// In degrees: round z from x, and above the plane of x and y.
export interface Angles {
  readonly azimuth: number; // above -180, at most 180
  readonly elevation: number; // -90 to 90
}

export function angles_of(normal: Vec3): Angles {
  const [x, y, z] = normalised(normal);
  return { azimuth: (Math.atan2(y, x) * 180) / Math.PI || 0, elevation: (Math.asin(Math.min(Math.max(z, -1), 1)) * 180) / Math.PI };
}

export function normal_of({ azimuth, elevation }: Angles): Vec3 {
  const [a, e] = [(azimuth * Math.PI) / 180, (Math.min(Math.max(elevation, -90), 90) * Math.PI) / 180];
  const clean = (x: number) => (Math.abs(x) < 1e-15 ? 0 : x); // of right angles
  return [clean(Math.cos(a) * Math.cos(e)), clean(Math.sin(a) * Math.cos(e)), clean(Math.sin(e))];
}

// By so many degrees to the right and up, as when the plane itself is dragged. Straight up the azimuth has no meaning, so it is kept beside the normal.
export const turned = ({ azimuth, elevation }: Angles, by_azimuth: number, by_elevation: number): Angles => ({
  azimuth: ((((azimuth + by_azimuth + 180) % 360) + 360) % 360) - 180 || 0,
  elevation: Math.min(Math.max(elevation + by_elevation, -90), 90),
});

// The normal of the plane through three points, which go round counterclockwise as they are seen; null where they lie on one line.
export function normal_through([a, b, c]: readonly [Vec3, Vec3, Vec3]): Vec3 | null {
  const normal = cross(normalised(plus(b, a, -1)), normalised(plus(c, a, -1)));
  return Math.hypot(...normal) > 1e-9 ? normalised(normal) : null;
}

// The axis along which a step of the crosshair moves the plane most: a cell along it is what the wheel steps by.
export function steepest(normal: Vec3): AxisIndex {
  const sizes = normal.map(Math.abs);
  return sizes.indexOf(Math.max(...sizes)) as AxisIndex;
}

// The corners of what the plane has in common with the domain, in order around it; none where it misses the domain.
export function outline_of(frame: PlaneFrame, axes: readonly [Axis, Axis, Axis]): Vec3[] {
  const corner = (n: number): Vec3 => for_axes((d) => (n & (1 << d) ? axes[d].max : axes[d].min));
  const height = (p: Vec3) => dot(frame.normal, plus(p, frame.through, -1));
  const met: Vec3[] = [];
  for (let n = 0; n < 8; ++n)
    for (let d = 0; d < 3; ++d) {
      if (n & (1 << d)) continue;
      const [a, b] = [corner(n), corner(n | (1 << d))];
      const [from, to] = [height(a), height(b)];
      if (from < 0 !== to < 0) met.push(plus(a, plus(b, a, -1), from / (from - to)));
    }
  const middle = met.reduce<Vec3>((sum, p) => plus(sum, p, 1 / met.length), [0, 0, 0]);
  const angle = (p: Vec3) => Math.atan2(dot(frame.up, plus(p, middle, -1)), dot(frame.right, plus(p, middle, -1)));
  return met.sort((p, q) => angle(p) - angle(q));
}
