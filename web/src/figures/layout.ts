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
  readonly low: number; // at the left, or at the bottom
  readonly high: number; // may be less
}

export interface Tick {
  readonly at: number; // a share of the axis
  readonly text: string;
}

export interface Place {
  readonly x: number;
  readonly y: number;
  readonly entry: number;
}

export interface Layout {
  readonly width: number;
  readonly height: number;
  readonly plot: Box;
  readonly title: number | null; // the middle of its line
  readonly across: readonly Tick[];
  readonly up: readonly Tick[];
  readonly names: { readonly across: number; readonly up: number } | null; // y of the one, x of the other
  readonly bar: number | null; // the middle of the scale bar's line, below the plot
  readonly legend: readonly Place[];
}

interface Wish {
  readonly width: number;
  readonly aspect: number; // the plot's height divided by its width
  readonly title: boolean;
  readonly axes: readonly [Scale, Scale] | null;
  readonly bar: boolean; // a scale bar
  readonly legend: readonly string[];
}

// Two at least, since one says nothing of the scale: where there is room for no more, the outer ones.
export function ticks_of({ low, high }: Pick<Scale, "low" | "high">, length: number, every = ACROSS): Tick[] {
  const ends = [Math.min(low, high), Math.max(low, high)] as const;
  const room = Math.max(1, Math.floor(length / every));
  let most = room;
  let places = ticks(...ends, most);
  while (places.length < 2 && most < 5) places = ticks(...ends, ++most); // steps are at most 2.5 times what is asked for
  const step = places[1]! - places[0]!;
  if (most > room) places = [places[0]!, places.at(-1)!];
  return places.map((x) => ({ at: (x - low) / (high - low), text: coordinate(x, 10 * step) })).sort((a, b) => a.at - b.at);
}

export function laid_out({ width, aspect, title, axes, bar, legend }: Wish, measure: Measure): Layout {
  const top = title ? TITLE + 10 : axes ? SIZE / 2 : 0;
  const up_ticks = (height: number) => (axes ? ticks_of(axes[1], height, UP) : []);
  const numbers = Math.max(0, ...up_ticks(width * aspect).map(({ text }) => measure(text)));
  const left = axes ? LINE + numbers + TICK + GAP : 0;
  const last = axes ? measure(ticks_of(axes[0], width).at(-1)?.text ?? "") / 2 : 0;
  const plot = { x: left, y: top, width: width - left - last, height: (width - left - last) * aspect };
  let y = plot.y + plot.height;
  const across_name = y + TICK + GAP + SIZE + LINE / 2 + 1;
  if (axes) y += TICK + GAP + SIZE + LINE + 2;
  if (bar) y += LINE;
  const entries = places_of(legend, plot.x, y, width, measure);
  return {
    width,
    height: entries.bottom + 2,
    plot,
    title: title ? TITLE / 2 + 3 : null,
    across: axes ? ticks_of(axes[0], plot.width) : [],
    up: up_ticks(plot.height),
    names: axes ? { across: across_name, up: LINE / 2 } : null,
    bar: bar ? y - LINE / 2 : null,
    legend: entries.places,
  };
}

type Measure = (text: string) => number;

// The entries of a legend, line by line.
function places_of(legend: readonly string[], left: number, top: number, width: number, measure: Measure): { places: Place[]; bottom: number } {
  if (legend.length === 0) return { places: [], bottom: top };
  const places: Place[] = [];
  let [x, y] = [left, top + 6];
  legend.forEach((name, entry) => {
    const wide = SIZE + 4 + measure(name) + 12;
    if (x > left && x + wide > width + 12) {
      x = left;
      y += LINE;
    }
    places.push({ x, y: y + LINE / 2, entry });
    x += wide;
  });
  return { places, bottom: y + LINE };
}

const [COLUMNS, GUTTER] = [2, 14];
export const panel_width = (width: number, panels: number): number => (panels === 1 ? width : (width - GUTTER) / COLUMNS);

// Several panels on one sheet, in rows of two, each with a heading of its own; below them one legend for all.
export function laid_out_together(panels: readonly Pick<Wish, "aspect" | "axes" | "bar">[], width: number, title: boolean, legend: readonly string[], measure: Measure) {
  const each = panel_width(width, panels.length);
  let top = title ? TITLE + 10 : 0;
  const layouts: Layout[] = [];
  for (let first = 0; first < panels.length; first += COLUMNS) {
    const row = panels.slice(first, first + COLUMNS).map((panel) => laid_out({ ...panel, width: each, title: true, legend: [] }, measure));
    row.forEach((layout, column) => layouts.push(moved(layout, column * (each + GUTTER), top)));
    top += Math.max(...row.map(({ height }) => height)) + GUTTER / 2;
  }
  const { places, bottom } = places_of(legend, 0, top, width, measure);
  return { width, height: bottom + 2, title: title ? TITLE / 2 + 3 : null, panels: layouts, legend: places };
}

const moved = (layout: Layout, dx: number, dy: number): Layout => ({
  ...layout,
  plot: { ...layout.plot, x: layout.plot.x + dx, y: layout.plot.y + dy },
  title: layout.title === null ? null : layout.title + dy,
  names: layout.names && { across: layout.names.across + dy, up: layout.names.up + dx },
  bar: layout.bar === null ? null : layout.bar + dy,
});

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
