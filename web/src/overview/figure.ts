// The lines and dots of the overview: the domain, the frames of the planes, the crosshair, the selected box, markers,
// and the measured distance. What is in front hides the lines `under`. The lines `over` show through everything; where
// a line is drawn both ways, the one over is faint. Pure.
import type { Viewer } from "../state/viewer";
import type { Projection } from "./space/camera";
import { edge_depths } from "./space/edges";
import { type Axes, type Space, type Vec3, point_to_space, to_space } from "./space/space";
import { type Rgba, type Segment, box_edges } from "./space/lines";
import type { Theme } from "./theme";

export interface Scenery {
  readonly at: Vec3; // the crosshair; all points are in the overview's space
  readonly box: { low: Vec3; high: Vec3 } | null;
  readonly markers: readonly Vec3[];
  readonly extents: readonly { low: Vec3; high: Vec3 }[]; // of what is marked
  readonly found: { low: Vec3; high: Vec3 } | null; // what "Go there" has gone to
  readonly measures: readonly { from: Vec3; to: Vec3; chosen: boolean }[];
}

export function scenery_of(viewer: Pick<Viewer, "box" | "marks" | "measures" | "chosen" | "isolated">, axes: Axes, space: Space, at: Vec3): Scenery {
  const box = viewer.box.value;
  const corner = (of: readonly number[], first: number) => axes.map((axis, d) => to_space(space, d, axis.plane(of[first + d]!))) as Vec3;
  const found = viewer.isolated.value?.box;
  return {
    at,
    box: box && { low: corner(box, 0), high: corner(box, 3) },
    markers: viewer.marks.value.map((marker) => point_to_space(space, marker.at)),
    extents: viewer.marks.value.flatMap(({ box: lies }) => (lies ? [{ low: corner(lies, 0), high: corner(lies, 3) }] : [])),
    found: found ? { low: corner(found, 0), high: corner(found, 3) } : null,
    measures: viewer.measures.value.map(({ id, from, to }) => ({ from: point_to_space(space, from), to: point_to_space(space, to), chosen: id === viewer.chosen.value })),
  };
}

const faint = ([r, g, b, a]: Rgba, share: number): Rgba => [r, g, b, a * share];

export function figure(view: Projection, half: Readonly<Vec3>, scenery: Scenery, theme: Theme): { under: Segment[]; over: Segment[] } {
  const under: Segment[] = [];
  const over: Segment[] = [];
  const low = half.map((h) => -h) as Vec3;
  const depths = edge_depths(view, half);
  box_edges(low, half).forEach(({ a, b }, i) =>
    under.push({ a, b, color: depths[i] === 2 ? faint(theme.edge, 0.45) : theme.edge, width: depths[i] === 1 ? 1.5 : 1 }),
  );

  for (let d = 0; d < 3; ++d) {
    const color = theme.axes[d]!;
    const [flat_low, flat_high] = [[...low] as Vec3, [...half] as Vec3];
    flat_low[d] = flat_high[d] = scenery.at[d]!;
    for (const { axis, a, b, place } of box_edges(flat_low, flat_high)) {
      // A flat box has each of its edges twice.
      const twice = (axis + 1) % 3 === d ? place & 1 : place & 2;
      if (axis !== d && !twice) under.push({ a, b, color: faint(color, 0.85), width: 1.25 });
    }
    const [a, b] = [[...scenery.at] as Vec3, [...scenery.at] as Vec3];
    a[d] = low[d]!;
    b[d] = half[d]!;
    under.push({ a, b, color: faint(color, 0.9), width: 1.25 });
  }

  if (scenery.box)
    for (const { a, b } of box_edges(scenery.box.low, scenery.box.high)) {
      under.push({ a, b, color: theme.box, width: 2 });
      over.push({ a, b, color: faint(theme.box, 0.3), width: 1.5 });
    }
  for (const { from, to, chosen } of scenery.measures) {
    over.push({ a: from, b: to, color: chosen ? theme.measure : faint(theme.measure, 0.7), width: chosen ? 2.5 : 1.5 });
    for (const end of [from, to]) over.push({ a: end, b: end, color: theme.measure, width: chosen ? 8 : 6 });
  }
  if (scenery.found)
    for (const { a, b } of box_edges(scenery.found.low, scenery.found.high)) {
      under.push({ a, b, color: theme.marker, width: 2.5 });
      over.push({ a, b, color: faint(theme.marker, 0.45), width: 1.5 });
    }
  for (const { low: a0, high: b0 } of scenery.extents)
    for (const { a, b } of box_edges(a0, b0)) over.push({ a, b, color: faint(theme.marker, 0.6), width: 1 });
  for (const p of scenery.markers) {
    over.push({ a: p, b: p, color: faint(theme.marker, 0.4), width: 9 });
    under.push({ a: p, b: p, color: [1, 1, 1, 1], width: 13 }, { a: p, b: p, color: theme.marker, width: 9 });
  }
  over.push({ a: scenery.at, b: scenery.at, color: [1, 1, 1, 0.9], width: 9 }, { a: scenery.at, b: scenery.at, color: theme.crosshair, width: 6 });
  return { under, over };
}
