// The overview's camera: it looks at a target from a direction and a distance. Angles are in degrees. z is up, or y.
// Views straight from above or below work like any other. Pure.
import type { Vec3 } from "./space";

export interface Orbit {
  readonly azimuth: number; // of the camera around the target: from +x towards +y, or from +z towards +x where y is up
  readonly elevation: number; // -90 to 90
  readonly distance: number;
  readonly target: Vec3;
  readonly sky: Sky;
}

export type Sky = 1 | 2; // the axis that is up
const STEEPEST = 89.999; // degrees: beyond, a camera that is given by two points and "up" could turn

export const FIELD = 26; // degrees: the field of view along the shorter side of the panel
const rad = (degrees: number) => (degrees * Math.PI) / 180;
export const dot = (a: Readonly<Vec3>, b: Readonly<Vec3>) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const add = (a: Readonly<Vec3>, b: Readonly<Vec3>, times = 1): Vec3 => [a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]];

// Unit vectors: right, up, and back from the target to the camera.
export function basis({ azimuth, elevation, sky }: Orbit): { right: Vec3; up: Vec3; back: Vec3 } {
  const [a, e] = [rad(azimuth), rad(Math.min(Math.max(elevation, -STEEPEST), STEEPEST))];
  const turned = (v: Vec3): Vec3 => (sky === 2 ? v : [v[1], v[2], v[0]]);
  return {
    right: turned([-Math.sin(a), Math.cos(a), 0]),
    up: turned([-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)]),
    back: turned([Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)]),
  };
}

export const eye_of = (orbit: Orbit): Vec3 => add(orbit.target, basis(orbit).back, orbit.distance);

// Half the width and half the height of the view at distance 1.
export function reach(aspect: number): { x: number; y: number } {
  const t = Math.tan(rad(FIELD / 2));
  return aspect >= 1 ? { x: t * aspect, y: t } : { x: t, y: t / aspect };
}

export const turned = (orbit: Orbit, azimuth: number, elevation: number): Orbit => ({
  ...orbit,
  azimuth: (((orbit.azimuth + azimuth) % 360) + 360) % 360,
  elevation: Math.min(Math.max(orbit.elevation + elevation, -90), 90),
});

// Moves the target in the plane of the picture, by shares of the height of the picture.
export function panned(orbit: Orbit, right: number, up: number, aspect: number): Orbit {
  const b = basis(orbit);
  const height = 2 * orbit.distance * reach(aspect).y;
  return { ...orbit, target: add(add(orbit.target, b.right, right * height), b.up, up * height) };
}

export const FARTHEST = 60;
// Moves towards the target, or away from it, but no nearer than `nearest`.
export const dollied = (orbit: Orbit, factor: number, nearest: number): Orbit => ({
  ...orbit,
  distance: Math.min(Math.max(orbit.distance * factor, nearest), FARTHEST),
});

// Makes a point on the line of sight of a pixel the one that the camera moves to and turns around: it goes to the depth
// of this point, and what is seen stays as it is.
export function at_depth_of(orbit: Orbit, p: Readonly<Vec3>): Orbit {
  const { back } = basis(orbit);
  const eye = eye_of(orbit);
  const distance = dot(add(eye, p, -1), back);
  return distance > 0 ? { ...orbit, distance, target: add(eye, back, -distance) } : orbit;
}

// Moves towards a point, or away from it, so that the point stays where it is seen.
export function dollied_to(orbit: Orbit, p: Readonly<Vec3>, factor: number, nearest: number): Orbit {
  const from = at_depth_of(orbit, p);
  const to = dollied(from, factor, nearest);
  const by = to.distance / from.distance;
  return { ...to, target: add(from.target, add(p, from.target, -1), 1 - by) };
}

// The view from a direction in which the box from -half to half fills this share of the panel.
export function fitted(half: Readonly<Vec3>, azimuth: number, elevation: number, aspect: number, share = 0.8, sky: Sky = 2): Orbit {
  const orbit: Orbit = { azimuth, elevation, distance: 1, target: [0, 0, 0], sky };
  const b = basis(orbit);
  const { x, y } = reach(aspect);
  let distance = 0;
  for (let corner = 0; corner < 8; ++corner) {
    const p: Vec3 = [corner & 1 ? half[0] : -half[0], corner & 2 ? half[1] : -half[1], corner & 4 ? half[2] : -half[2]];
    const across = Math.max(Math.abs(dot(p, b.right)) / x, Math.abs(dot(p, b.up)) / y) / share;
    distance = Math.max(distance, across + dot(p, b.back));
  }
  return { ...orbit, distance };
}

// Whether a point lies near what the camera looks at: within the picture, and not much farther away.
export function in_sight(orbit: Orbit, p: Readonly<Vec3>, aspect: number): boolean {
  const b = basis(orbit);
  const { x, y } = reach(aspect);
  const from = add(p, orbit.target, -1);
  return Math.abs(dot(from, b.right)) < x * orbit.distance && Math.abs(dot(from, b.up)) < y * orbit.distance && Math.abs(dot(from, b.back)) < orbit.distance;
}

export const HOME = { azimuth: -122, elevation: 24 };
// The direction from the upper or the lower end of an axis.
export const straight = (axis: number, from_above: boolean, sky: Sky = 2): { azimuth: number; elevation: number } =>
  axis === sky ? { azimuth: -90, elevation: from_above ? 90 : -90 } : { azimuth: ((axis + 2 - sky) % 3) * 90 + (from_above ? 0 : 180), elevation: 0 };

// A view on the way from one view to another. The azimuth turns the shorter way round. The target moves as the distance
// shrinks or grows, so that what is seen moves evenly.
export function between(a: Orbit, b: Orbit, t: number): Orbit {
  const turn = ((((b.azimuth - a.azimuth) % 360) + 540) % 360) - 180;
  const mix = (x: number, y: number) => x + (y - x) * t;
  const ratio = b.distance / a.distance;
  const share = Math.abs(ratio - 1) < 1e-6 ? t : (1 - ratio ** t) / (1 - ratio);
  return {
    azimuth: a.azimuth + turn * t,
    elevation: mix(a.elevation, b.elevation),
    distance: a.distance * ratio ** t,
    target: add(a.target, add(b.target, a.target, -1), share),
    sky: b.sky,
  };
}

export interface Projection {
  readonly right: Vec3;
  readonly up: Vec3;
  readonly back: Vec3;
  readonly eye: Vec3;
  readonly width: number; // CSS pixels
  readonly height: number;
  readonly reach: { x: number; y: number };
}

export const projection_of = (orbit: Orbit, width: number, height: number): Projection => ({
  ...basis(orbit),
  eye: eye_of(orbit),
  width,
  height,
  reach: reach(width / height),
});

// Where a point appears: in CSS pixels from the upper left corner of the panel, and how far away along the line of
// sight, which is not positive at or behind the camera.
export function project(view: Projection, p: Readonly<Vec3>): { x: number; y: number; far: number } {
  const from_eye = add(p, view.eye, -1);
  const far = -dot(from_eye, view.back);
  const x = dot(from_eye, view.right) / (far * view.reach.x);
  const y = dot(from_eye, view.up) / (far * view.reach.y);
  return { x: ((1 + x) / 2) * view.width, y: ((1 - y) / 2) * view.height, far };
}

// The direction from the eye to a pixel; not of unit length.
export function direction_at(view: Projection, x: number, y: number): Vec3 {
  const right = ((2 * x) / view.width - 1) * view.reach.x;
  const up = (1 - (2 * y) / view.height) * view.reach.y;
  return add(add([-view.back[0], -view.back[1], -view.back[2]], view.right, right), view.up, up);
}

// Takes the line through p that is parallel to axis d. Returns the coordinate along d at which this line comes nearest
// to the ray through a pixel; null when the axis points at the eye.
export function along_axis(view: Projection, p: Readonly<Vec3>, d: number, x: number, y: number): number | null {
  const ray = direction_at(view, x, y);
  const w = add(p, view.eye, -1);
  const [rr, r] = [dot(ray, ray), ray[d]!];
  const below = rr - r * r; // of the unit axis and the ray: |ray|^2 - (ray . axis)^2
  if (below < 1e-4 * rr) return null;
  return p[d]! + (r * dot(ray, w) - rr * w[d]!) / below;
}
