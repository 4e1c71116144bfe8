// Which edges of a box carry the numbers. There is one per axis: of its edges on the outline, as the camera sees it,
// the lowest, or for z the leftmost. Also which edges lie behind the box, and which in front of it. Pure.
import { type Projection, project } from "./camera";
import type { Vec3 } from "./space";
import { box_edges } from "./lines";

export interface LabelledEdge {
  readonly a: Vec3; // the lower end
  readonly b: Vec3;
  readonly from: { x: number; y: number }; // in CSS pixels
  readonly to: { x: number; y: number };
  readonly outward: { x: number; y: number }; // a unit vector away from the box's middle, across the edge
}

// For each of the twelve edges of box_edges(): 0 behind the box, 1 on its outline, 2 in front of it. Seen from inside
// the box, all edges are behind it.
export function edge_depths(view: Projection, half: Readonly<Vec3>): number[] {
  const faces_eye = (d: number, upper: boolean) => (upper ? view.eye[d]! > half[d]! : view.eye[d]! < -half[d]!);
  return box_edges([0, 0, 0], [1, 1, 1]).map(
    ({ axis, place }) => Number(faces_eye((axis + 1) % 3, (place & 1) !== 0)) + Number(faces_eye((axis + 2) % 3, (place & 2) !== 0)),
  );
}

const SHORTEST = 36; // pixels: an edge that is seen end-on has no room for numbers

export function labelled_edges(view: Projection, half: Readonly<Vec3>): (LabelledEdge | null)[] {
  const low = half.map((h) => -h) as Vec3;
  const edges = box_edges(low, half);
  const depths = edge_depths(view, half);
  const middle = project(view, [0, 0, 0]);
  return [0, 1, 2].map((axis) => {
    let best: { edge: LabelledEdge; rank: number } | null = null;
    edges.forEach((edge, i) => {
      if (edge.axis !== axis || depths[i] !== 1) return;
      const from = project(view, edge.a);
      const to = project(view, edge.b);
      const length = Math.hypot(to.x - from.x, to.y - from.y);
      if (from.far <= 0 || to.far <= 0 || length < SHORTEST) return;
      const [x, y] = [(from.x + to.x) / 2, (from.y + to.y) / 2];
      let outward = { x: -(to.y - from.y) / length, y: (to.x - from.x) / length };
      if (outward.x * (x - middle.x) + outward.y * (y - middle.y) < 0) outward = { x: -outward.x, y: -outward.y };
      const rank = axis === 2 ? -x : y;
      if (!best || rank > best.rank) best = { edge: { a: edge.a, b: edge.b, from, to, outward }, rank };
    });
    return (best as { edge: LabelledEdge } | null)?.edge ?? null;
  });
}
