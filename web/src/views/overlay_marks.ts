// The parts of an overlay that people put there: the pinned cell, the box, markers, the measured line.
import { label_of_measure } from "../state/measures";
import type { Box, Measure } from "../state/viewer";
import { grouped } from "../base/format";
import type { AxisIndex } from "../base/grid";
import { cells_between, extent_in, handles_of } from "./drawing/box_handles";
import { length_text } from "../base/lengths";
import type { Pen } from "./drawing/pen";

// Lines that lie in another slice are dashed.
const ELSEWHERE = [5, 4];

export function draw_pin(pen: Pen): void {
  const { viewer, frame, ink, axis, camera } = pen;
  const pin = viewer.pinned.value;
  if (!pin) return;
  const dash = pin[axis] === viewer.cell.value[axis] ? [] : ELSEWHERE;
  const extent = { u0: pin[frame.u], u1: pin[frame.u] + 1, v0: pin[frame.v], v1: pin[frame.v] + 1 };
  const { left, right, top, bottom } = camera.place_of(extent);
  if (Math.min(right - left, bottom - top) >= 10) {
    pen.cells(extent, ink.accent, { width: 2, dash });
    return;
  }
  // The cell is too small to be seen, so a square surrounds it.
  const [x, y] = [pen.crisp((left + right) / 2), pen.crisp((top + bottom) / 2)];
  pen.path([[x - 6, y - 6], [x + 6, y - 6], [x + 6, y + 6], [x - 6, y + 6]], ink.accent, { width: 2, dash, close: true });
}

const LEAST_CUT = 8; // CSS pixels: in smaller cells a line would say nothing

// The plane within the cell under the pointer: the line in which it meets the plane of the slice, clipped to the cell.
export function draw_cut(pen: Pen): void {
  const { viewer, frame, axis, camera } = pen;
  const cut = viewer.cut.value;
  if (!cut || cut.cell[axis] !== viewer.cell.value[axis]) return;
  const { cell, plane } = cut;
  const [across, up, through] = [camera.across, camera.up, viewer.axes[axis]];
  const [u, v] = [cell[frame.u], cell[frame.v]];
  const ends = line_in_cell(
    [plane.normal[frame.u], plane.normal[frame.v]],
    plane.offset - plane.normal[axis] * through.centre(cell[axis]),
    [across.plane(u), up.plane(v), across.plane(u + 1), up.plane(v + 1)],
  );
  const size = Math.min(across.width(u), up.width(v)) * camera.zoom;
  if (!ends || size < LEAST_CUT) return;
  pen.path(ends.map(([x, y]) => [camera.x_of(x), camera.y_of(y)] as const), pen.ink.accent, { width: 2 });
}

// The part of the line n . (x, y) = offset within a rectangle [x0, y0, x1, y1]; null when it does not pass through.
export function line_in_cell(
  n: readonly [number, number],
  offset: number,
  [x0, y0, x1, y1]: readonly [number, number, number, number],
): [[number, number], [number, number]] | null {
  const corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]] as const;
  const side = corners.map(([x, y]) => n[0] * x + n[1] * y - offset);
  const ends: [number, number][] = [];
  corners.forEach(([x, y], i) => {
    const [next, a, b] = [corners[(i + 1) % 4]!, side[i]!, side[(i + 1) % 4]!];
    if (a < 0 === b < 0) return;
    const t = a / (a - b);
    ends.push([x + t * (next[0] - x), y + t * (next[1] - y)]);
  });
  return ends.length === 2 ? [ends[0]!, ends[1]!] : null;
}

const BELOW_HEADING = 46; // CSS pixels from the top of a view, where a line of text is free of the heading

export function draw_box(pen: Pen, box: Box | null): void {
  if (!box) return;
  const { frame, axis, viewer } = pen;
  const slice = viewer.cell.value[axis];
  const here = slice >= box[axis] && slice < box[axis + 3]!;
  pen.rectangle(pen.line_around(extent_in(frame, box)), pen.ink.accent, { width: 2, dash: here ? [] : ELSEWHERE });
  for (const { x, y } of handles_of(pen.camera, frame, box)) pen.handle(x, y);
  const { camera } = pen;
  const sizes = [frame.u, frame.v].map((d) => length_text(viewer.axes[d]!.plane(box[d + 3]!) - viewer.axes[d]!.plane(box[d]!), viewer.info.units, 4));
  const { left, right, top } = camera.place_of(extent_in(frame, box));
  const y = top - 18 < BELOW_HEADING ? Math.max(top + 18, BELOW_HEADING) : top - 18;
  if (right > 0 && left < camera.width && top < camera.height && top > -16) pen.plate(sizes.join(" × "), (left + right) / 2, y, pen.ink.accent);
}

const LONGEST = 60; // letters beside a marker
const NEAR = 40; // CSS pixels from the slice up to which a marker is shown, the fainter the farther away

const APART = 14; // CSS pixels between markers

// One line of text, in CSS pixels; y is its middle.
export interface Label {
  readonly left: number;
  readonly right: number;
  readonly y: number;
}
const LINE = 16; // CSS pixels

export const overlap = (a: Label, b: Label): boolean => a.left < b.right && b.left < a.right && Math.abs(a.y - b.y) < LINE;

const HATCH = 7; // CSS pixels between lines

// Where something that was found lies.
function draw_extent(pen: Pen, box: Box, hatched: boolean): void {
  const { camera, context, frame, ink } = pen;
  const { left, right, top, bottom } = camera.place_of(extent_in(frame, box));
  if (right < 0 || left > camera.width || bottom < 0 || top > camera.height) return;
  context.globalAlpha = 0.75;
  pen.cells(extent_in(frame, box), ink.marker, { width: 1, dash: [3, 3] });
  if (hatched && bottom - top > 2 && right - left > 2) {
    context.save();
    context.beginPath();
    context.rect(left, top, right - left, bottom - top);
    context.clip();
    const [x0, x1, y0, y1] = [Math.max(left, 0), Math.min(right, camera.width), Math.max(top, 0), Math.min(bottom, camera.height)];
    context.beginPath();
    for (let x = Math.floor((x0 - (y1 - y0)) / HATCH) * HATCH; x < x1; x += HATCH) {
      context.moveTo(x, y1);
      context.lineTo(x + (y1 - y0), y0);
    }
    context.strokeStyle = ink.marker;
    context.lineWidth = 1;
    context.stroke();
    context.restore();
  }
  context.globalAlpha = 1;
}

// The box of what "Go there" has gone to.
export function draw_found(pen: Pen): void {
  const box = pen.viewer.isolated.value?.box;
  if (!box) return;
  const slice = pen.viewer.cell.value[pen.axis];
  pen.rectangle(pen.line_around(extent_in(pen.frame, box)), pen.ink.marker, { width: 2, dash: slice >= box[pen.axis] && slice < box[pen.axis + 3]! ? [] : ELSEWHERE });
}

// The worst comes first. A marker very near to an earlier one is left out, and so is a label that would lie over an earlier one or be cut.
export function draw_markers(pen: Pen, level: number): void {
  const { camera, viewer, frame, axis, ink, context } = pen;
  const across = viewer.axes[axis];
  const slice = viewer.cell.value[axis];
  const [low, high] = [across.plane((slice >> level) * 2 ** level), across.plane(Math.min(((slice >> level) + 1) * 2 ** level, across.cells))];
  const labels: Label[] = [];
  for (const { box, guess } of viewer.marks.value) if (box && slice >= box[axis] && slice < box[axis + 3]!) draw_extent(pen, box, guess === true);
  const tips: (readonly [number, number])[] = [];
  for (const { at, text, name } of viewer.marks.value) {
    const w = at[axis];
    const away = Math.max(low - w, w - high, 0) * camera.zoom;
    if (away > NEAR) continue;
    const [x, y] = [camera.x_of(at[frame.u]), camera.y_of(at[frame.v])];
    if (tips.some(([p, q]) => Math.hypot(x - p, y - q) < APART)) continue;
    tips.push([x, y]);
    context.globalAlpha = 1 - (0.8 * away) / NEAR;
    pen.path([[x, y], [x - 6, y - 14], [x + 6, y - 14]], ink.marker, { width: 2, close: true });
    context.fillStyle = ink.marker;
    context.fill();
    const words = name ?? (text.length > LONGEST ? `${text.slice(0, LONGEST - 1)}…` : text);
    const label = { left: x + 11, right: x + 11 + context.measureText(words).width, y: y - 10 };
    if (away === 0 && label.right < camera.width && !labels.some((other) => overlap(label, other))) {
      pen.text(words, label.left, label.y);
      labels.push(label);
    }
    context.globalAlpha = 1;
  }
}

// How many cells a line passes along the axes of the slice: one number where it runs along one of them.
function cells_text({ frame, viewer }: Pen, { from, to }: Measure): string {
  const [a, b] = [frame.u, frame.v].map((d) => cells_between(viewer.axes[d as AxisIndex], from[d]!, to[d]!)) as [number, number];
  if (a === 0 || b === 0) return `${grouped(a + b)} ${a + b === 1 ? "cell" : "cells"}`;
  return `${grouped(a)} × ${grouped(b)} cells`;
}

// The lines that were drawn in this view. Those of three dimensions are many views' matter: of them the chosen one is drawn.
export function draw_measures(pen: Pen): void {
  const { viewer, axis } = pen;
  for (const measure of viewer.measures.value) {
    const is_chosen = measure.id === viewer.chosen.value;
    if (measure.axis === axis || (measure.axis === null && is_chosen)) draw_measure(pen, measure, is_chosen);
  }
}

function draw_measure(pen: Pen, measure: Measure, is_chosen: boolean): void {
  const { viewer, camera, axis, frame, ink } = pen;
  const place = (p: readonly number[]) => [camera.x_of(p[frame.u]!), camera.y_of(p[frame.v]!)] as const;
  const [[x0, y0], [x1, y1]] = [place(measure.from), place(measure.to)];
  const pixels = Math.hypot(x1 - x0, y1 - y0);
  // Bars across both ends.
  const [nx, ny] = pixels > 0 ? [(-(y1 - y0) / pixels) * 6, ((x1 - x0) / pixels) * 6] : [0, 6];
  const elsewhere = measure.from[axis] !== viewer.axes[axis].centre(viewer.cell.value[axis]);
  const width = is_chosen ? 2 : 1;
  pen.path([[x0 - nx, y0 - ny], [x0 + nx, y0 + ny]], ink.accent, { width });
  pen.path([[x1 - nx, y1 - ny], [x1 + nx, y1 + ny]], ink.accent, { width });
  pen.path([[x0, y0], [x1, y1]], ink.accent, { width, dash: elsewhere ? ELSEWHERE : [] });
  const label = label_of_measure(measure, viewer.info.units);
  pen.plate(is_chosen && measure.axis !== null ? `${label} · ${cells_text(pen, measure)}` : label, (x0 + x1) / 2, (y0 + y1) / 2 - 18, ink.accent);
}
