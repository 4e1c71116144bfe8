// The parts of an overlay that show the place: lines between cells, the border of the grid, rulers, the crosshair, the
// scale bar.
import type { Axis } from "../base/axis";
import { coordinate } from "../base/format";
import { AXES, AXIS_NAMES, type AxisIndex } from "../base/grid";
import { length_text, round_length } from "../base/lengths";
import { extent_in } from "./drawing/box_handles";
import type { Pen } from "./drawing/pen";

const LINES_FROM = 7; // CSS pixels: smaller cells get no lines
const LINES_FULL = 20; // CSS pixels: lines of cells this large have their full strength
const BAR = 130; // CSS pixels of the longest scale bar
const NAMES = 46; // CSS pixels that the names of the axes take
const RULER_STEP = 90; // CSS pixels: the smallest distance between coordinates on a ruler

// Draws the planes in sight whose cells are large enough. On a graded axis that may be so in one place and not in
// another.
export function draw_cell_lines(pen: Pen): void {
  const { camera, context, ink } = pen;
  const seen = camera.seen();
  const [r, g, b] = ink.line;
  const lines = (axis: Axis, from: number, to: number, place: (coordinate: number) => number, draw: (at: number) => void) => {
    if ((to - from) * LINES_FROM > 4 * Math.max(camera.width, camera.height)) return;
    const size = (i: number) => (axis.plane(i + 1) - axis.plane(i)) * camera.zoom;
    for (let i = Math.max(from, 1); i < Math.min(to + 1, axis.cells); ++i) {
      const smaller = Math.min(size(i - 1), size(i));
      if (smaller < LINES_FROM) continue;
      context.fillStyle = `rgb(${r} ${g} ${b} / ${Math.min(1, 0.25 + (smaller - LINES_FROM) / (LINES_FULL - LINES_FROM)) * 0.32})`;
      draw(Math.floor(place(axis.plane(i)) * camera.ratio) / camera.ratio);
    }
  };
  const [left, right] = [Math.max(camera.x_of(camera.across.min), 0), Math.min(camera.x_of(camera.across.max), camera.width)];
  const [top, bottom] = [Math.max(camera.y_of(camera.up.max), 0), Math.min(camera.y_of(camera.up.min), camera.height)];
  const one = 1 / camera.ratio;
  lines(camera.across, seen.u0, seen.u1, (u) => camera.x_of(u), (x) => context.fillRect(x, top, one, bottom - top));
  lines(camera.up, seen.v0, seen.v1, (v) => camera.y_of(v), (y) => context.fillRect(left, y, right - left, one));
}

const MARK = 5; // CSS pixels: the thickness of the mark of the smallest cell
const BELOW_TITLE = 42; // CSS pixels: the title of a view ends above
const TEXT = 130; // CSS pixels: as much as the mark's text takes

// Of axes with planes of their own: where the smallest cell is, which decides the time step of many solvers, above and right of the grid.
export function draw_smallest_cells(pen: Pen): void {
  const { camera, context, ink, frame, viewer } = pen;
  const { across, up, width, height } = camera;
  const text = (axis: Axis) => `smallest ${length_text(axis.finest, viewer.info.units)}`;
  const stretch = (a: number, b: number): [number, number] => [Math.min(a, b), Math.max(Math.abs(b - a), 3)];
  if (across.graded) {
    const [x, length] = stretch(camera.x_of(across.plane(across.thinnest)), camera.x_of(across.plane(across.thinnest + 1)));
    const y = Math.min(Math.max(camera.y_of(up.max) - MARK, BELOW_TITLE), height - BELOW_TITLE);
    context.fillStyle = ink.axes[frame.u];
    context.fillRect(x, y, length, MARK);
    if (x > 0 && x < width) pen.label(text(across), Math.min(Math.max(x, TEXT / 2), width - TEXT / 2), y > BELOW_TITLE + 20 ? y - 11 : y + MARK + 11, "center");
  }
  if (up.graded) {
    const [y, length] = stretch(camera.y_of(up.plane(up.thinnest)), camera.y_of(up.plane(up.thinnest + 1)));
    const x = Math.min(Math.max(camera.x_of(across.max), 0), width - MARK);
    context.fillStyle = ink.axes[frame.v];
    context.fillRect(x, y, MARK, length);
    const beside = x + MARK + TEXT < width;
    if (y > BELOW_TITLE && y < height - BELOW_TITLE) pen.label(text(up), beside ? x + MARK + 7 : x - 7, y + length / 2, beside ? "left" : "right");
  }
}

export function draw_border(pen: Pen): void {
  const { across, up } = pen.camera;
  pen.cells({ u0: 0, u1: across.cells, v0: 0, v1: up.cells }, pen.ink.border, { width: 1 });
}

// Round coordinates along the lower and left edge.
export function draw_rulers(pen: Pen): void {
  const { camera, context, ink, frame } = pen;
  const step = round_length((2 * RULER_STEP) / camera.zoom);
  const marks = (axis: Axis, low: number, high: number, draw: (at: number, text: string) => void) => {
    const [from, to] = [Math.max(low, axis.min), Math.min(high, axis.max)];
    const first = Math.ceil(from / step - 1e-9);
    for (let k = 0; k < 64 && (first + k) * step <= to * (1 + 1e-12) + 1e-12 * step; ++k)
      draw((first + k) * step, coordinate((first + k) * step, 10 * step));
  };
  const low = camera.height - 1;
  const tick = (x: number, y: number, width: number, height: number) => {
    context.fillStyle = ink.text;
    context.fillRect(x, y, width, height);
  };
  // The corner is left to the names of the axes.
  marks(camera.across, camera.u_at(0), camera.u_at(camera.width), (u, text) => {
    const x = camera.x_of(u);
    tick(pen.crisp(x) - 0.5, low - 5, 1, 6);
    const half = context.measureText(text).width / 2 + 4;
    if (x - half > NAMES && x + half < camera.width) pen.label(text, x, low - 8, "center", "bottom");
  });
  marks(camera.up, camera.v_at(camera.height), camera.v_at(0), (v, text) => {
    const y = camera.y_of(v);
    tick(0, pen.crisp(y) - 0.5, 6, 1);
    if (y > 44 && y < camera.height - 56) pen.label(text, 9, y);
  });
  draw_name(pen, `${AXIS_NAMES[frame.u]} →`, low - 15, ink.axes[frame.u]);
  draw_name(pen, `${AXIS_NAMES[frame.v]} ↑`, low - 37, ink.axes[frame.v]);
}

// It is drawn on a plate, because the colours of axes cannot be read on every material.
function draw_name({ context, ink }: Pen, text: string, y: number, color: string): void {
  const plain = context.font;
  context.font = `600 ${plain}`;
  context.fillStyle = ink.plate;
  context.beginPath();
  context.roundRect(8, y - 10, context.measureText(text).width + 10, 20, 4);
  context.fill();
  context.textAlign = "left";
  context.textBaseline = "middle";
  context.fillStyle = color;
  context.fillText(text, 13, y + 0.5);
  context.font = plain;
}

const GAP = 7; // CSS pixels around the cell, so that it stays visible

// Each line shows where another view cuts, in the colour of that view. A thin box that they meet in stays visible, too.
export function draw_crosshair(pen: Pen): void {
  const { camera, frame, ink, viewer } = pen;
  const cell = viewer.cell.value;
  const at = (d: AxisIndex) => viewer.axes[d].centre(cell[d]);
  const [x, y] = [pen.crisp(camera.x_of(at(frame.u))), pen.crisp(camera.y_of(at(frame.v)))];
  const size = (axis: Axis, i: number) => ((axis.plane(i + 1) - axis.plane(i)) * camera.zoom) / 2;
  const [gap_x, gap_y] = [Math.max(GAP, size(camera.across, cell[frame.u]) + 2), Math.max(GAP, size(camera.up, cell[frame.v]) + 2)];
  const box = viewer.box.value;
  const around = box && AXES.every((d) => cell[d] >= box[d] && cell[d] < box[d + 3]!) ? pen.line_around(extent_in(frame, box)) : null;
  const held = around?.clear ? around : { left: x, right: x, top: y, bottom: y };
  const [left, right, top, bottom] = [Math.min(x - gap_x, held.left), Math.max(x + gap_x, held.right), Math.min(y - gap_y, held.top), Math.max(y + gap_y, held.bottom)];
  const line = (points: [number, number][], color: string) => pen.path(points, color, { width: 2 });
  if (x >= 0 && x <= camera.width) {
    if (top > 0) line([[x, 0], [x, Math.min(top, camera.height)]], ink.axes[frame.u]);
    if (bottom < camera.height) line([[x, Math.max(bottom, 0)], [x, camera.height]], ink.axes[frame.u]);
  }
  if (y >= 0 && y <= camera.height) {
    if (left > 0) line([[0, y], [Math.min(left, camera.width), y]], ink.axes[frame.v]);
    if (right < camera.width) line([[Math.max(right, 0), y], [camera.width, y]], ink.axes[frame.v]);
  }
}

export function draw_scale_bar(pen: Pen): void {
  const { camera, context, ink, viewer } = pen;
  const length = round_length(Math.min(BAR, camera.width / 3) / camera.zoom);
  const width = length * camera.zoom;
  const [right, y] = [camera.width - 14, camera.height - 30];
  context.fillStyle = ink.halo;
  context.fillRect(right - width - 2, y - 5, width + 4, 8);
  context.fillStyle = ink.text;
  context.fillRect(right - width, y - 3, width, 4);
  pen.text(length_text(length, viewer.info.units), right - width / 2, y - 8, ink.text, "center", "bottom");
}
