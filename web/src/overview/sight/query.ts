// What the server is asked to look at, as parts of an address.
import type { Index3 } from "../../base/grid";
import { ranges } from "../../base/ranges";
import { get_json } from "../../server/api";
import type { Viewer } from "../../state/viewer";
import type { Sight } from "./layers";
import { type Sights, decode_sights } from "./sights";
import { type Orbit, dot, eye_of, reach } from "../space/camera";
import { type Space, type Vec3, from_space } from "../space/space";

// By what coordinates are multiplied to be those of the file.
const to_file = ({ info }: Viewer) => info.to_file ?? 1;

// The camera.
export function camera_query(viewer: Viewer, space: Space, orbit: Orbit, width: number, height: number): string {
  const point = (p: Vec3) => p.map((x, d) => from_space(space, d, x) * to_file(viewer)).join(",");
  const field = (2 * Math.atan(reach(width / height).y) * 180) / Math.PI;
  return `size=${width},${height}&fov=${field}&from=${point(eye_of(orbit))}&at=${point(orbit.target)}&up=${orbit.sky === 1 ? "y" : "z"}`;
}

export const sight_of = ({ shown_looks, bodies, small }: Viewer): Sight => ({ looks: shown_looks.value, mode: bodies.value, small: small.value });

// What is cut away.
export function cut_of(viewer: Viewer): string {
  const at = viewer.centre_of(viewer.cell.value).map((x) => x * to_file(viewer)) as Vec3;
  if (viewer.bodies.value === "cut") return `&open=${at.join(",")}`;
  const normal = viewer.plane_normal.value;
  if (viewer.bodies.value === "plane" && normal) return `&plane=${normal.join(",")},${dot(normal, at)}`;
  return "";
}

export const PART = 384; // pixels along a side of what is asked for at once

export type Get = (address: string) => Promise<Response>;

// What is seen of each layer of labels.
export const fetch_layers = (viewer: Viewer, space: Space, layers: readonly (readonly number[])[], query: string, get: Get): Promise<Sights[]> =>
  Promise.all(
    (layers.length ? layers : [[]]).map(async (labels) => {
      const response = await get(viewer.address.view("bin", `${query}&labels=${ranges(labels)}&damage=1`));
      return decode_sights(await response.arrayBuffer(), space.scale / to_file(viewer));
    }),
  );

// What is seen of some labels at a point of a picture, in pixels.
export interface Seen {
  readonly at: readonly [number, number, number];
  readonly cell: Index3;
  readonly distance: number;
  readonly label: number | null; // null: it can't be read
  readonly material: number | null;
  readonly body: string | null;
}
export async function fetch_seen(viewer: Viewer, labels: readonly number[], query: string, x: number, y: number, signal: AbortSignal): Promise<Seen | null> {
  const { seen } = await get_json<{ seen: Seen | null }>(viewer.address.view("json", `${query}&labels=${ranges(labels)}&level=0&damage=1&pixel=${x},${y}`), signal);
  const shown = (length: number) => length / to_file(viewer);
  return seen && { ...seen, at: seen.at.map(shown) as [number, number, number], distance: shown(seen.distance) };
}
