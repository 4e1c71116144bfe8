// What is looked at: the bodies of a grid, or something else that pictures of it are made from.
import { ranges } from "../../base/ranges";
import type { Viewer } from "../../state/viewer";
import { type Colored, compose } from "./compose";
import { layers_of, palette_of } from "./layers";
import { type Get, type Seen, camera_query, cut_of, fetch_layers, fetch_seen, labels_query, sight_of } from "./query";
import type { Sights } from "./sights";
import type { Orbit } from "../space/camera";
import type { Space } from "../space/space";

// From where, in how many pixels, and what is cut away of each grid.
export interface Sighting {
  readonly orbit: Orbit;
  readonly width: number;
  readonly height: number;
  readonly cuts: readonly string[]; // parts of addresses
}

export interface SightSubject {
  key(): string; // of what is looked at, whatever the sighting
  cuts(): readonly string[];
  fetch(from: Sighting, more: string, get: Get): Promise<readonly Sights[]>; // a layer at least
  color(layers: readonly Sights[]): Colored;
  seen_at(from: Sighting, x: number, y: number, signal: AbortSignal): Promise<Seen | null>; // of single cells
  name_of(label: number): string; // of a layer
  unreadable(): number; // the label of what can't be read
}

export const UNREADABLE = "can't be read";

// `cut_by`: at whose crosshair they are cut.
export function bodies_of(viewer: Viewer, space: Space, cut_by = viewer): SightSubject {
  const layers = () => layers_of(sight_of(viewer));
  const query = ({ orbit, width, height, cuts }: Sighting) => `${camera_query(viewer, space, orbit, width, height)}${cuts[0]}`;
  return {
    key: () => layers().map(ranges).join(" "),
    cuts: () => [cut_of(viewer, cut_by)],
    fetch: (from, more, get) => fetch_layers(viewer, space, layers(), query(from) + more, get),
    color: (seen) => compose(seen, palette_of(sight_of(viewer))),
    seen_at: (from, x, y, signal) =>
      fetch_seen(viewer, query(from) + labels_query(layers()), x, y, signal, ({ label }) => (label === null ? UNREADABLE : viewer.name_of(label))),
    unreadable: () => viewer.labels.length,
    name_of: (label) => (label === viewer.labels.length ? UNREADABLE : viewer.name_of(label)),
  };
}
