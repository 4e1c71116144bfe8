// Where the parts of a figure stand. Lengths are points from the upper left corner. Pure but for the widths of texts.
import type { Axis } from "../base/axis";
import { coordinate } from "../base/format";
import { ticks } from "../base/ticks";
import type { Box } from "./sheet";

export const SIZE = 8; // of text
export const TITLE = 11;
const LINE = 12;
const TICK = 3;
const GAP = 4;
const [ACROSS, UP] = [55, 28]; // between ticks, at least: numbers are wider than high
export const NARROWEST = 36; // of a plot

export interface Scale {
  readonly name: string; // as in "x [mm]"
  readonly low: number;
  readonly high: number;
}

export interface Tick {
  readonly at: number; // a share of the axis
  readonly text: string;
}

export interface Layout {
  readonly width: number;
  readonly height: number;
  readonly plot: Box;
  readonly title: number | null; // the middle of its line
  readonly across: readonly Tick[];
  readonly up: readonly Tick[];
  readonly names: { readonly across: number; readonly up: number } | null; // y of the one, x of the other
  readonly legend: readonly { readonly x: number; readonly y: number; readonly entry: number }[];
}

interface Wish {
  readonly width: number;
  readonly aspect: number; // the plot's height divided by its width
  readonly title: boolean;
  readonly axes: readonly [Scale, Scale] | null;
  readonly legend: readonly string[];
}

export function ticks_of({ low, high }: Scale, length: number, every = ACROSS): Tick[] {
  const places = ticks(low, high, Math.max(1, Math.floor(length / every)));
  const step = places.length > 1 ? Math.abs(places[1]! - places[0]!) : high - low;
  return places.map((x) => ({ at: (x - low) / (high - low), text: coordinate(x, 10 * step) }));
}

export function laid_out({ width, aspect, title, axes, legend }: Wish, measure: (text: string) => number): Layout {
  const top = title ? TITLE + 10 : axes ? SIZE / 2 : 0;
  const up_ticks = (height: number) => (axes ? ticks_of(axes[1], height, UP) : []);
  const numbers = Math.max(0, ...up_ticks(width * aspect).map(({ text }) => measure(text)));
  const left = axes ? LINE + numbers + TICK + GAP : 0;
  const last = axes ? measure(ticks_of(axes[0], width).at(-1)?.text ?? "") / 2 : 0;
  const plot = { x: left, y: top, width: width - left - last, height: (width - left - last) * aspect };
  let y = plot.y + plot.height;
  const across_name = y + TICK + GAP + SIZE + LINE / 2 + 1;
  if (axes) y += TICK + GAP + SIZE + LINE + 2;
  const places: { x: number; y: number; entry: number }[] = [];
  let x = plot.x;
  if (legend.length > 0) y += 6;
  legend.forEach((name, entry) => {
    const wide = SIZE + 4 + measure(name) + 12;
    if (x > plot.x && x + wide > width + 12) {
      x = plot.x;
      y += LINE;
    }
    places.push({ x, y: y + LINE / 2, entry });
    x += wide;
  });
  if (legend.length > 0) y += LINE;
  return {
    width,
    height: y + 2,
    plot,
    title: title ? TITLE / 2 + 3 : null,
    across: axes ? ticks_of(axes[0], plot.width) : [],
    up: up_ticks(plot.height),
    names: axes ? { across: across_name, up: LINE / 2 } : null,
    legend: places,
  };
}

const LEAST_CELL = 1.5; // points: smaller cells get no lines

// Where planes lie within a picture of so many points, between cells that are large enough.
export function planes_within(axis: Axis, { low, high }: Pick<Scale, "low" | "high">, size: number): number[] {
  const zoom = size / (high - low);
  const out: number[] = [];
  const last = Math.min(axis.cells - 1, axis.cell_at(high));
  for (let i = Math.max(1, axis.cell_at(low)); i <= last; ++i) {
    const at = (axis.plane(i) - low) * zoom;
    if (at > 0 && at < size && Math.min(axis.width(i - 1), axis.width(i)) * zoom >= LEAST_CELL) out.push(at);
  }
  return out;
}
