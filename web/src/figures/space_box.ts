// The domain around a picture in three dimensions: its edges, and the coordinates along three of them.
import { AXES, AXIS_NAMES } from "../base/grid";
import { edge_depths, labelled_edges } from "../overview/space/edges";
import { type Projection, project } from "../overview/space/camera";
import { box_edges } from "../overview/space/lines";
import { type Space, type Vec3, to_space } from "../overview/space/space";
import type { Viewer } from "../state/viewer";
import { SIZE, ticks_of } from "./layout";
import { type Sheet, text_width } from "./sheet";

const LINE = 0.6; // points
const INSIDE = "#9aa3af"; // edges that are not on the outline
const TICK = 3;
const GAP = 3;
const EVERY = 40; // points between numbers, at least

// Where points of the overview's space lie on a sheet. Their unit is the point, of which an inch has 72.
export interface Placing {
  readonly view: Projection; // of a panel that is as wide as the whole view would be on the sheet
  readonly x: number; // its upper left corner
  readonly y: number;
}

// What the whole box takes of the view, as shares of its width and height.
export function box_share(view: Projection, half: Readonly<Vec3>): { x0: number; y0: number; x1: number; y1: number } | null {
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((n) => project(view, half.map((h, d) => (n & (1 << d) ? h : -h)) as Vec3));
  if (corners.some(({ far }) => far <= 0)) return null;
  const [xs, ys] = [corners.map(({ x }) => x / view.width), corners.map(({ y }) => y / view.height)];
  return { x0: Math.min(...xs), y0: Math.min(...ys), x1: Math.max(...xs), y1: Math.max(...ys) };
}

// The edges behind the picture, or the others.
export function draw_edges(sheet: Sheet, { view, x, y }: Placing, space: Space, ink: string, behind: boolean): void {
  const depths = edge_depths(view, space.half);
  box_edges(space.half.map((h) => -h) as Vec3, space.half).forEach(({ a, b }, i) => {
    if ((depths[i] === 0) !== behind) return;
    const [p, q] = [project(view, a), project(view, b)];
    if (p.far > 0 && q.far > 0) sheet.line(x + p.x, y + p.y, x + q.x, y + q.y, depths[i] === 1 ? ink : INSIDE, depths[i] === 1 ? LINE : LINE / 2);
  });
}

export function draw_coordinates(sheet: Sheet, { view, x, y }: Placing, viewer: Viewer, space: Space, ink: string): void {
  const edges = labelled_edges(view, space.half);
  for (const d of AXES) {
    const edge = edges[d];
    if (!edge) continue;
    const axis = viewer.axes[d];
    const { x: ox, y: oy } = edge.outward;
    const place = (coordinate: number) => {
      const p: Vec3 = [...edge.a];
      p[d] = to_space(space, d, coordinate);
      const at = project(view, p);
      return [x + at.x, y + at.y] as const;
    };
    const write = (text: string, [px, py]: readonly [number, number], away: number) => {
      const wide = text_width(text, { size: SIZE });
      const by = away + (Math.abs(ox) * wide) / 2 + (Math.abs(oy) * SIZE) / 2;
      sheet.text(text, px + ox * by, py + oy * by, { size: SIZE, align: "center", color: ink });
    };
    const numbers = ticks_of({ low: axis.min, high: axis.max }, Math.hypot(edge.to.x - edge.from.x, edge.to.y - edge.from.y), EVERY);
    for (const { at, text } of numbers) {
      const [px, py] = place(axis.min + at * (axis.max - axis.min));
      sheet.line(px, py, px + ox * TICK, py + oy * TICK, ink, LINE);
      write(text, [px, py], TICK + GAP);
    }
    const widest = Math.max(0, ...numbers.map(({ text }) => text_width(text, { size: SIZE })));
    write(`${AXIS_NAMES[d]} [${viewer.units}]`, place((axis.min + axis.max) / 2), TICK + GAP + 2 + Math.abs(ox) * widest + Math.abs(oy) * SIZE + 2);
  }
}
