// An axis of the grid. It maps cell indices to coordinates and back, by the same rule as the store.
import { type AxisIndex, type AxisJson, type GridInfo, for_axes } from "./grid";

// The last of `count` stretches, one after another, that has begun; the first one has.
export function last_begun(count: number, has_begun: (i: number) => boolean): number {
  let low = 0;
  let high = count;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (has_begun(middle)) low = middle;
    else high = middle;
  }
  return low;
}

export class Axis {
  readonly cells: number;
  readonly min: number;
  readonly max: number;
  readonly graded: boolean;
  readonly thinnest: number; // the thinnest cell, the first of several
  readonly finest: number; // its width
  private readonly planes: Float64Array | null;

  constructor(
    private readonly json: AxisJson,
    private readonly sample: number,
  ) {
    this.planes = json.type === "graded" ? Float64Array.from(json.planes) : null;
    this.graded = this.planes !== null;
    this.cells = json.type === "graded" ? json.planes.length - 1 : json.cells;
    this.min = this.plane(0);
    this.max = this.plane(this.cells);
    let thinnest = 0;
    this.planes?.forEach((plane, i, all) => {
      if (i + 1 < all.length && all[i + 1]! - plane < all[thinnest + 1]! - all[thinnest]!) thinnest = i;
    });
    this.thinnest = thinnest;
    this.finest = this.planes ? this.plane(thinnest + 1) - this.plane(thinnest) : (this.max - this.min) / this.cells;
  }

  // Cell i lies between plane(i) and plane(i + 1).
  plane(i: number): number {
    if (this.json.type === "graded") return this.planes![i]!;
    return this.json.min + (this.json.first + i) * this.json.step;
  }

  // The width of cell i, or of the nearest cell when i lies outside.
  width(i: number): number {
    const c = this.clamp(i);
    return this.plane(c + 1) - this.plane(c);
  }

  // The coordinate of cell i's sample point, which decides its material.
  centre(i: number): number {
    if (this.json.type === "graded") return this.planes![i]! + this.sample * (this.planes![i + 1]! - this.planes![i]!);
    return this.json.min + (this.json.first + i + this.sample) * this.json.step;
  }

  // The cell that holds a coordinate: -1 below the axis, `cells` above it.
  cell_at(x: number): number {
    if (x < this.min) return -1;
    if (x >= this.max) return this.cells;
    if (this.json.type === "uniform") {
      let i = Math.floor((x - this.json.min) / this.json.step) - this.json.first;
      while (i > 0 && x < this.plane(i)) --i; // the division rounds
      while (i + 1 < this.cells && x >= this.plane(i + 1)) ++i;
      return Math.min(Math.max(i, 0), this.cells - 1);
    }
    return last_begun(this.cells, (i) => this.planes![i]! <= x);
  }

  // The cell that is drawn for an interval [low, high); -1 for none. Usually it is the cell that holds the middle of
  // the interval. When that cell reaches beyond the interval while thinner cells lie entirely within it, it is the
  // middle one of those, so that thin cells are not passed over. When the whole axis lies within the interval, it is
  // the middle cell of the axis, so that a domain thinner than a pixel is still drawn.
  cell_among(low: number, high: number): number {
    const middle = this.cell_at((low + high) / 2);
    const inside = middle >= 0 && middle < this.cells;
    if (inside && !this.graded) return middle;
    const [before, after] = [this.cell_at(low), this.cell_at(high)];
    if (!inside) return before < 0 && after >= this.cells ? (this.cells - 1) >> 1 : -1;
    return (middle === before || middle === after) && after - before >= 2 ? (before + after) >> 1 : middle;
  }

  // The nearest cell, and the nearest coordinate, of the axis.
  clamp(i: number): number {
    return Math.min(Math.max(Math.round(i), 0), this.cells - 1);
  }
  inside(x: number): number {
    return Math.min(Math.max(x, this.min), this.max);
  }
}

export const axes_of = ({ grid }: GridInfo): [Axis, Axis, Axis] => for_axes((d) => new Axis(grid.axes[d]!, grid.sample[d]!));

// The axes of a slice across `w`: u points right and v points up. Across z they are (x, y), across y (x, z), across x
// (y, z).
export interface Frame {
  readonly u: AxisIndex;
  readonly v: AxisIndex;
  readonly w: AxisIndex;
}
export const FRAMES: readonly [Frame, Frame, Frame] = [
  { u: 1, v: 2, w: 0 },
  { u: 0, v: 2, w: 1 },
  { u: 0, v: 1, w: 2 },
];
