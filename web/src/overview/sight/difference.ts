// What differs between two grids, seen in three dimensions: the surfaces of each material, as both grids have them along the same lines of sight.
// Where one has a surface in front of the other's, or alone, it was added or removed; where both have it at the same place, it is a veil. Materials
// have layers of their own, so that what lies within another material is seen, too.
import type { Axis } from "../../base/axis";
import { AXES } from "../../base/grid";
import { rgb_of_color } from "../../base/materials";
import { type Palette, STRIPES, VEILS, compose } from "./compose";
import { type Get, camera_query, cut_of, fetch_layers, fetch_seen } from "./query";
import { type Sighting, type SightSubject, UNREADABLE } from "./subject";
import type { Sights } from "./sights";
import type { Space } from "../space/space";
import type { Viewer } from "../../state/viewer";

// Labels of what is merged.
const [SAME, REMOVED, ADDED, DAMAGED] = [0, 1, 2, 3];
const WORDS = ["in both", "removed", "added", UNREADABLE];
const MOST_ALONE = 5; // materials that have a layer of their own

const FLATTEST = 0.1; // the cosine of a surface that is seen nearly from its side

// `damaged`: the labels of what can't be read. `slack`: how far from each other two surfaces may lie that are the same one; besides what distances are rounded by.
export function merged(a: Sights, b: Sights, damaged: readonly [number, number], slack: number): Sights {
  const n = a.width * a.height;
  const label = new Uint8Array(n);
  const [far, own, added, facing] = [new Float32Array(n), new Uint8Array(n), new Uint8Array(n), new Uint8Array(n)];
  const from_b = new Uint8Array(n);
  const rounding = 2 * (a.step + b.step);
  for (let i = 0; i < n; ++i) {
    const [has_a, has_b] = [a.label[i]! > 0, b.label[i]! > 0];
    if (!has_a && !has_b) continue;
    const [p, q] = [has_a ? a.far[i]! : Infinity, has_b ? b.far[i]! : Infinity];
    from_b[i] = Number(q < p);
    const source = from_b[i] ? b : a;
    const across = Math.max(source.facing[i]! / 255, FLATTEST); // how much of a depth lies across the surface
    const is_same = has_a && has_b && Math.abs(p - q) <= slack / across + rounding * Math.min(p, q);
    const is_damaged = source.label[i] === 1 + damaged[from_b[i] as 0 | 1];
    label[i] = 1 + (is_damaged ? DAMAGED : is_same ? SAME : q < p ? ADDED : REMOVED);
    far[i] = source.far[i]!;
    own[i] = source.own[i]!;
    added[i] = source.added[i]!;
    facing[i] = source.facing[i]!;
  }
  // The edges of the surface that a pixel shows; where it shows nothing, of either.
  const places: number[] = [];
  const points: { label: number[]; own: number[]; added: number[]; facing: number[] } = { label: [], own: [], added: [], facing: [] };
  for (const [side, of] of [[0, a], [1, b]] as const)
    of.edges.at.forEach((at, e) => {
      const shows = label[at]!;
      if (shows > 0 && from_b[at] !== side) return;
      places.push(at);
      for (let k = 4 * e; k < 4 * e + 4; ++k) {
        points.label.push(of.edges.label[k]! === 0 ? 0 : shows || 1 + SAME);
        for (const part of ["own", "added", "facing"] as const) points[part].push(of.edges[part][k]!);
      }
    });
  const bytes = Uint8Array.from.bind(Uint8Array) as (list: readonly number[]) => Uint8Array;
  const edges = { at: Uint32Array.from(places), label: bytes(points.label), own: bytes(points.own), added: bytes(points.added), facing: bytes(points.facing) };
  return { width: a.width, height: a.height, step: Math.max(a.step, b.step), label, far, own, added, facing, edges };
}

// The labels of each side that belong together, by the names of materials: the first ones alone, the others as one.
export function paired_layers(left: Viewer, right: Viewer): [number[], number[]][] {
  const shown = (viewer: Viewer) => {
    const of = new Map<string, number[]>();
    viewer.label_looks.value.forEach(({ visible, opacity, material }, label) => {
      if (material === 0 || !visible || opacity === 0) return;
      const { name } = viewer.info.materials[material]!;
      of.set(name, [...(of.get(name) ?? []), label]);
    });
    return of;
  };
  const [a, b] = [shown(left), shown(right)];
  const names = [...new Set([...a.keys(), ...b.keys()])];
  const pair = (some: readonly string[]) => [a, b].map((of) => some.flatMap((name) => of.get(name) ?? []).sort((x, y) => x - y)) as [number[], number[]];
  const alone = names.slice(0, MOST_ALONE).map((name) => pair([name]));
  return names.length > MOST_ALONE ? [...alone, pair(names.slice(MOST_ALONE))] : alone;
}

function same_planes(a: Axis, b: Axis): boolean {
  if (a.cells !== b.cells || a.graded !== b.graded) return false;
  if (!a.graded) return a.min === b.min && a.max === b.max;
  for (let i = 0; i <= a.cells; ++i) if (a.plane(i) !== b.plane(i)) return false;
  return true;
}

function widest_of(axis: Axis): number {
  if (!axis.graded) return axis.finest;
  let widest = 0;
  for (let i = 0; i < axis.cells; ++i) widest = Math.max(widest, axis.width(i));
  return widest;
}

// Surfaces of unequal cells are the same where they lie within a cell of each other.
function slack_of(left: Viewer, right: Viewer, space: Space): number {
  if (AXES.every((d) => same_planes(left.axes[d], right.axes[d]))) return 0;
  return space.scale * Math.hypot(...AXES.map((d) => Math.max(widest_of(left.axes[d]), widest_of(right.axes[d]))));
}

// In the colours of the style sheet.
function palette_in(root: HTMLElement): Palette {
  const style = getComputedStyle(root);
  const squares = [[128, 134, 144], ...["--removed", "--added"].map((name) => rgb_of_color(style.getPropertyValue(name).trim())), ...STRIPES].flat().map((c) => (c / 255) ** 2);
  return { squares: Float32Array.from(squares), opacity: new Float32Array(5).fill(1), veil: Uint8Array.from(["faint", "solid", "solid", "solid", "solid"] as const, (one) => VEILS.indexOf(one)), damaged: DAMAGED };
}

export function difference_of(left: Viewer, right: Viewer, space: Space): SightSubject {
  const sides = [left, right] as const;
  const slack = slack_of(left, right, space);
  const query = (side: 0 | 1, { orbit, width, height, cuts }: Sighting) => `${camera_query(sides[side], space, orbit, width, height)}${cuts[side]}`;
  return {
    key: () => JSON.stringify(paired_layers(left, right)),
    cuts: () => sides.map((side) => cut_of(side, left)),
    fetch: async (from, more, get: Get) => {
      const pairs = paired_layers(left, right);
      const of = (side: 0 | 1) => fetch_layers(sides[side], space, pairs.map((pair) => pair[side]), query(side, from) + more, get);
      const [a, b] = await Promise.all([of(0), of(1)]);
      return a.map((layer, n) => merged(layer, b[n]!, [left.labels.length, right.labels.length], slack));
    },
    color: (layers) => compose(layers, palette_in(document.documentElement)),
    seen_at: async (from, x, y, signal) => {
      const pairs = paired_layers(left, right);
      const found = await Promise.all(
        ([0, 1] as const).map((side) => {
          const grid = sides[side];
          const name_of = (label: number | null) => `${label === null ? UNREADABLE : grid.name_of(label)} in ${grid.info.id}`;
          return fetch_seen(grid, pairs.flatMap((pair) => pair[side]).sort((p, q) => p - q), query(side, from), x, y, signal, name_of);
        }),
      );
      const nearest = Math.min(...found.map((seen) => seen?.distance ?? Infinity));
      return found.find((seen) => seen?.distance === nearest) ?? null;
    },
    unreadable: () => DAMAGED,
    name_of: (label) => WORDS[label]!,
  };
}
