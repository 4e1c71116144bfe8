// What differs between two grids, seen in three dimensions: the cells that have another material in the other grid, as the server finds them
// along lines of sight. They are seen through a veil of what the grid on the left shows.
import { rgb_of_color } from "../../base/materials";
import type { Viewer } from "../../state/viewer";
import { type Palette, STRIPES, VEILS, compose } from "./compose";
import { layers_of } from "./layers";
import { type Get, camera_query, cut_of, fetch_layers, fetch_seen, fetch_sights, labels_query, sight_of } from "./query";
import type { Sights } from "./sights";
import type { Space } from "../space/space";
import { type Sighting, type SightSubject, UNREADABLE } from "./subject";

// Labels of the picture. The server knows the first three, and after them what can't be read.
const [REMOVED, ADDED, OTHER, VEIL, DAMAGED] = [0, 1, 2, 3, 4];
const KINDS = ["removed", "added", "other material"] as const;
const WORDS = [...KINDS, "the same in both", UNREADABLE];

// The same sights with labels of the picture.
export function relabelled(sights: Sights, to: (label: number) => number): Sights {
  const all = (labels: Sights["label"]) => Uint8Array.from(labels, (code) => (code === 0 ? 0 : 1 + to(code - 1)));
  return { ...sights, label: all(sights.label), edges: { ...sights.edges, label: all(sights.edges.label) } };
}

// In the colours that the slices have.
function palette_in(root: HTMLElement): Palette {
  const style = getComputedStyle(root);
  const colors = ["--removed", "--added", "--differs"].map((name) => rgb_of_color(style.getPropertyValue(name).trim()));
  const squares = [...colors, [128, 134, 144], ...STRIPES].flat().map((c) => (c / 255) ** 2);
  const veil = colors.map(() => VEILS.indexOf("solid"));
  return {
    squares: Float32Array.from(squares),
    opacity: new Float32Array(6).fill(1),
    veil: Uint8Array.from([...veil, VEILS.indexOf("faint"), ...veil]),
    damaged: DAMAGED,
  };
}

const cells_in = ({ cells }: Viewer): number => cells.reduce((product, n) => product * n, 1);

export function difference_of(left: Viewer, right: Viewer, space: Space): SightSubject {
  // The server goes through the grid of fewer cells: surfaces that lie within one of them are the same.
  const turned = cells_in(right) < cells_in(left);
  const [walked, other] = turned ? [right, left] : [left, right];
  const kind_of = (label: number) => (!turned || label === OTHER ? label : label === ADDED ? REMOVED : ADDED);
  const query = ({ orbit, width, height, cuts }: Sighting, of: Viewer) => `${camera_query(of, space, orbit, width, height)}${cuts[of === left ? 0 : 1]}`;
  const against = (from: Sighting) => `${query(from, walked)}&against=${encodeURIComponent(other.info.id)}`;
  const veil = () => layers_of({ ...sight_of(left), mode: "glass", small: new Set() });
  return {
    key: () => JSON.stringify(veil()),
    cuts: () => [left, right].map((side) => cut_of(side, left)),
    fetch: async (from, more, get: Get) => {
      const [found, seen] = await Promise.all([
        fetch_sights(walked, space, against(from) + more, get),
        fetch_layers(left, space, veil(), query(from, left) + more, get),
      ]);
      const known = left.labels.length;
      return [
        relabelled(found, (label) => (label < KINDS.length ? kind_of(label) : DAMAGED)),
        ...seen.map((sights) => relabelled(sights, (label) => (label < known ? VEIL : DAMAGED))),
      ];
    },
    // What differs is what is seen at a pixel, also behind the veil.
    color: (layers) => {
      const seen = compose(layers, palette_in(document.documentElement));
      layers[0]!.label.forEach((code, i) => {
        if (code === 0) return;
        seen.label[i] = code;
        seen.far[i] = layers[0]!.far[i]!;
      });
      return seen;
    },
    seen_at: async (from, x, y, signal) => {
      const [found, behind] = await Promise.all([
        fetch_seen(walked, against(from), x, y, signal, ({ label, from: own = [], to: others = [] }) => {
          if (label === null) return UNREADABLE;
          const [before, after] = turned ? [others, own] : [own, others];
          return `${WORDS[kind_of(label)]}: ${before.join(", ")} → ${after.join(", ")}`;
        }),
        fetch_seen(left, query(from, left) + labels_query(veil()), x, y, signal, ({ label }) => (label === null ? UNREADABLE : `${left.name_of(label)}, ${WORDS[VEIL]}`)),
      ]);
      return found ? { ...found, label: null } : behind;
    },
    unreadable: () => DAMAGED,
    name_of: (label) => WORDS[label]!,
  };
}
