// What the server is asked to look at, as parts of an address.
import { AXIS_NAMES, type AxisIndex, type Index3, type ThicknessAnswer } from "../../base/grid";
import { ranges } from "../../base/ranges";
import { get_json } from "../../server/api";
import type { Viewer } from "../../state/viewer";
import type { Sight } from "./layers";
import { type Sights, decode_sights } from "./sights";
import { type Orbit, dot, eye_of, reach } from "../space/camera";
import { type Space, type Vec3, from_space } from "../space/space";

// By what coordinates are multiplied to be those of the file.
const to_file = ({ info }: Viewer) => info.to_file ?? 1;

const file_point = (viewer: Viewer, space: Space, p: Vec3): string => p.map((x, d) => from_space(space, d, x) * to_file(viewer)).join(",");

// The camera.
export function camera_query(viewer: Viewer, space: Space, orbit: Orbit, width: number, height: number): string {
  const point = (p: Vec3) => file_point(viewer, space, p);
  const field = (2 * Math.atan(reach(width / height).y) * 180) / Math.PI;
  return `size=${width},${height}&fov=${field}&from=${point(eye_of(orbit))}&at=${point(orbit.target)}&up=${orbit.sky === 1 ? "y" : "z"}`;
}

// The whole domain from the upper end of an axis, without perspective, as large as it can be. What is cut away is what an orbit has in front.
export function straight_query(viewer: Viewer, space: Space, axis: AxisIndex, orbit: Orbit, width: number, height: number): string {
  const eye = viewer.bodies.value === "cut" ? `&open-from=${file_point(viewer, space, eye_of(orbit))}` : "";
  return `size=${width},${height}&view=-${AXIS_NAMES[axis]}&up=${AXIS_NAMES[orbit.sky]}${cut_of(viewer)}${eye}`;
}

export const sight_of = ({ shown_looks, bodies, small }: Viewer): Sight => ({ looks: shown_looks.value, mode: bodies.value, small: small.value });

// What is cut away, at the crosshair of the same viewer or another one.
export function cut_of(viewer: Viewer, by = viewer): string {
  const at = by.centre_of(by.cell.value).map((x) => x * to_file(viewer)) as Vec3;
  if (viewer.bodies.value === "cut") return `&open=${at.join(",")}`;
  const normal = viewer.plane_normal.value;
  if (viewer.bodies.value === "plane" && normal) return `&plane=${normal.join(",")},${dot(normal, at)}`;
  return "";
}

export const PART = 384; // pixels along a side of what is asked for at once

export type Get = (address: string) => Promise<Response>;

export async function fetch_sights(viewer: Viewer, space: Space, query: string, get: Get, perspective = true): Promise<Sights> {
  const response = await get(viewer.address.view("bin", `${query}&damage=1`));
  return decode_sights(await response.arrayBuffer(), space.scale / to_file(viewer), perspective);
}

// What is seen of each layer of labels.
export const fetch_layers = (viewer: Viewer, space: Space, layers: readonly (readonly number[])[], query: string, get: Get, perspective = true): Promise<Sights[]> =>
  Promise.all((layers.length ? layers : [[]]).map((labels) => fetch_sights(viewer, space, `${query}${labels_query([labels])}`, get, perspective)));

// What is seen at a point of a picture.
export interface Seen {
  readonly grid: Viewer; // whose cell it is
  readonly name: string;
  readonly at: readonly [number, number, number];
  readonly cell: Index3;
  readonly distance: number;
  readonly label: number | null; // null: it can't be read
  readonly material: number | null;
  readonly body: string | null;
}
interface Answer extends Omit<Seen, "grid" | "name"> {
  readonly from?: readonly string[]; // of what differs: the names of materials in this grid and in the other one
  readonly to?: readonly string[];
}
// What is seen at a point in pixels. `name_of`: what that is called.
export async function fetch_seen(viewer: Viewer, query: string, x: number, y: number, signal: AbortSignal, name_of: (seen: Answer) => string): Promise<Seen | null> {
  const { seen } = await get_json<{ seen: Answer | null }>(viewer.address.view("json", `${query}&level=0&damage=1&pixel=${x},${y}`), signal);
  return seen && { ...seen, grid: viewer, name: name_of(seen), at: shown_point(viewer, seen.at), distance: seen.distance / to_file(viewer) };
}

export const labels_query = (layers: readonly (readonly number[])[]): string => `&labels=${ranges(layers.flat().sort((a, b) => a - b))}`;

const shown_point = (viewer: Viewer, [x, y, z]: readonly [number, number, number]): Vec3 => [x / to_file(viewer), y / to_file(viewer), z / to_file(viewer)];

// How thick the material of what is seen is there, and where a line along the normal of its surface enters it and leaves it; null: there is none.
export async function fetch_thickness({ grid, cell, at }: Seen, signal: AbortSignal): Promise<{ name: string; from: Vec3; to: Vec3 } | null> {
  const address = grid.address.thickness(cell, at.map((x) => x * to_file(grid)));
  const { thickness } = await get_json<ThicknessAnswer>(address, signal);
  return thickness && { name: thickness.name, from: shown_point(grid, thickness.from), to: shown_point(grid, thickness.to) };
}
