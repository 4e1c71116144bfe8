// Makes a figure: gets what its subject needs, lays it out, and draws it.
import { coordinate } from "../base/format";
import { AXIS_NAMES, type AxisIndex } from "../base/grid";
import { png_of } from "../base/download";
import type { Viewer } from "../state/viewer";
import type { Rgb } from "../tiles/sets";
import { length_text, round_length } from "../base/lengths";
import { CanvasSheet } from "./canvas_sheet";
import { type Layout, NARROWEST, SIZE, TITLE, laid_out, planes_within } from "./layout";
import { type FigureOptions, points_of } from "./options";
import { with_density } from "./png";
import { type Sheet, text_width } from "./sheet";
import { slice_subject } from "./slice_subject";
import type { Picture, Subject } from "./subject";
import { SvgSheet } from "./svg_sheet";

const LINE = 0.6; // points
const HAIR = 0.15; // points: a line between cells
const LEAST_TITLE = 6; // points: a long title is made smaller, down to this
const BAR = 4; // the longest scale bar, as a part of the width

const COLORS = {
  white: { ground: [255, 255, 255], ink: "#16181d" },
  clear: { ground: null, ink: "#16181d" },
  black: { ground: [0, 0, 0], ink: "#f2f4f8" },
} as const satisfies Record<string, { ground: Rgb | null; ink: string }>;

interface Entry {
  readonly name: string;
  readonly color: string;
  readonly opacity: number;
}

// What is seen, in the order of materials: bodies alone where they have a colour of their own.
export function legend_of(viewer: Viewer, labels: readonly number[]): Entry[] {
  const entries = new Map<string, Entry & { order: number }>();
  for (const label of labels) {
    const look = viewer.shown_looks.peek()[label]!;
    if (!look.visible || look.opacity === 0 || look.faint) continue;
    const is_own = viewer.body_looks.peek().get(label)?.color !== undefined;
    const name = is_own ? viewer.name_of(label) : viewer.info.materials[look.material]!.name;
    entries.set(name, { name, color: `rgb(${look.color.join(",")})`, opacity: look.opacity, order: look.material });
  }
  return [...entries.values()].sort((a, b) => a.order - b.order);
}

// What the figure is called: "stadium-z-27.037m".
export function name_of(viewer: Viewer, { subject, format }: FigureOptions): string {
  if (subject === "3d") return `${viewer.info.id}-3d.${format}`;
  const d = AXIS_NAMES.indexOf(subject) as AxisIndex;
  const [axis, i] = [viewer.axes[d], viewer.cell.peek()[d]];
  const place = axis.centre(i).toFixed(Math.max(0, Math.ceil(-Math.log10(axis.width(i))) + 1));
  return `${viewer.info.id}-${subject}-${place}${viewer.info.units}.${format}`;
}

// A title that says what is shown.
export function standard_title(viewer: Viewer, { subject }: Pick<FigureOptions, "subject">): string {
  if (subject === "3d") return viewer.info.id;
  const d = AXIS_NAMES.indexOf(subject) as AxisIndex;
  const i = viewer.cell.value[d];
  return `${viewer.info.id}, ${subject} = ${coordinate(viewer.axes[d].centre(i), viewer.axes[d].width(i))} ${viewer.units}`;
}

function draw(sheet: Sheet, viewer: Viewer, options: FigureOptions, { subject, layout, legend }: Drawing, draw_picture: () => void): void {
  const { ground, ink } = COLORS[options.ground];
  const { plot } = layout;
  if (ground) sheet.fill({ x: 0, y: 0, width: layout.width, height: layout.height }, `rgb(${ground.join(",")})`);
  draw_picture();
  const text = { size: SIZE, color: ink };
  if (layout.title !== null) {
    const room = layout.width - plot.x;
    const size = Math.max(Math.min(TITLE, (TITLE * room) / text_width(options.title, { size: TITLE, bold: true })), LEAST_TITLE);
    sheet.text(options.title, plot.x, layout.title, { size, bold: true, color: ink });
  }
  if (options.lines && subject.axes && subject.planes) {
    const [across, up] = subject.planes;
    for (const at of planes_within(across, subject.axes[0], plot.width)) sheet.line(plot.x + at, plot.y, plot.x + at, plot.y + plot.height, ink, HAIR);
    for (const at of planes_within(up, subject.axes[1], plot.height)) {
      const y = plot.y + plot.height - at;
      sheet.line(plot.x, y, plot.x + plot.width, y, ink, HAIR);
    }
  }
  if (options.axes && subject.axes) {
    sheet.frame(plot, ink, LINE);
    const [bottom, left] = [plot.y + plot.height, plot.x];
    for (const { at, text: number } of layout.across) {
      const x = plot.x + at * plot.width;
      sheet.line(x, bottom, x, bottom + 3, ink, LINE);
      sheet.text(number, x, bottom + 7 + SIZE / 2, { ...text, align: "center" });
    }
    for (const { at, text: number } of layout.up) {
      const y = bottom - at * plot.height;
      sheet.line(left - 3, y, left, y, ink, LINE);
      sheet.text(number, left - 5, y, { ...text, align: "right" });
    }
    sheet.text(subject.axes[0].name, plot.x + plot.width / 2, layout.names!.across, { ...text, align: "center" });
    sheet.text(subject.axes[1].name, layout.names!.up, plot.y + plot.height / 2, { ...text, align: "center", upright: true });
  }
  if (options.bar) {
    const length = round_length(subject.length / BAR);
    const width = (length / subject.length) * plot.width;
    const [x, y] = [plot.x + plot.width - 8 - width, plot.y + plot.height - 8];
    sheet.fill({ x: x - 5, y: y - 13, width: width + 10, height: 18 }, options.ground === "black" ? "#000000" : "#ffffff", 0.75); // legible on any material
    sheet.fill({ x, y: y - 1, width, height: 2 }, ink);
    sheet.text(length_text(length, viewer.info.units), x + width / 2, y - 7, { ...text, align: "center" });
  }
  for (const { x, y, entry } of layout.legend) {
    const { name, color, opacity } = legend[entry]!;
    const swatch = { x, y: y - SIZE / 2, width: SIZE, height: SIZE };
    sheet.fill(swatch, color, opacity);
    sheet.frame(swatch, ink, 0.3);
    sheet.text(name, x + SIZE + 4, y, text);
  }
}

async function subject_of(viewer: Viewer, options: FigureOptions, signal: AbortSignal): Promise<Subject> {
  const { ground } = COLORS[options.ground];
  if (options.subject !== "3d") return slice_subject(viewer, AXIS_NAMES.indexOf(options.subject) as AxisIndex, options, ground, signal);
  const { space_subject } = await import("./space_subject");
  return space_subject(viewer, options, ground, signal);
}

const MOST = 64e6; // pixels
const SHAPES = 8192; // pixels across, as fine as which shapes are at most

interface Drawing {
  readonly scale: number; // pixels per point
  readonly subject: Subject;
  readonly picture: Picture;
  readonly layout: Layout;
  readonly legend: readonly Entry[];
}

// `scale_for`: pixels per point, for a layout without its legend. Throws when it would have too many pixels.
async function drawing_of(viewer: Viewer, options: FigureOptions, scale_for: (layout: Layout) => number, signal: AbortSignal): Promise<Drawing> {
  const subject = await subject_of(viewer, options, signal);
  const measure = (text: string) => text_width(text, { size: SIZE });
  const layout_of = (legend: readonly string[]) =>
    laid_out({ width: points_of(options), aspect: subject.aspect, title: options.title !== "", axes: options.axes ? subject.axes : null, legend }, measure);
  const bare = layout_of([]);
  if (bare.plot.width < NARROWEST) throw new Error("the figure is too narrow for its axes: make it wider, or leave them out");
  const shapes = options.format === "svg";
  const scale = shapes ? Math.min(options.dpi / 72, SHAPES / bare.width, SHAPES / bare.height) : scale_for(bare);
  const [width, height] = [Math.round(bare.width * scale), Math.round(bare.height * scale)];
  if (width * height > MOST) throw new Error(`${width} × ${height} pixels are more than the ${MOST / 1e6} million that can be made`);
  const picture = await subject.fetch(Math.max(1, Math.round(bare.plot.width * scale)), shapes, signal);
  const legend = options.legend ? legend_of(viewer, picture.labels) : [];
  return { scale, subject, picture, layout: layout_of(legend.map(({ name }) => name)), legend };
}

function on_canvas(viewer: Viewer, options: FigureOptions, drawing: Drawing): HTMLCanvasElement {
  const { scale, picture, layout } = drawing;
  const sheet = new CanvasSheet(layout.width, layout.height, scale);
  draw(sheet, viewer, options, drawing, () => picture.paint(sheet, layout));
  return sheet.canvas;
}

// What the figure will look like, at most this many pixels wide and high, and how many pixels high it will be.
export async function preview_of(viewer: Viewer, options: FigureOptions, most: number, signal: AbortSignal): Promise<{ canvas: HTMLCanvasElement; height: number }> {
  const pixels = { ...options, format: "png" as const };
  const drawing = await drawing_of(viewer, pixels, ({ width, height }) => Math.min(most / width, most / height), signal);
  return { canvas: on_canvas(viewer, pixels, drawing), height: (drawing.layout.height * options.dpi) / 72 };
}

// Throws when it can't be made. REQUIRES: fault_of() finds none in the options.
export async function make_figure(viewer: Viewer, options: FigureOptions, signal: AbortSignal): Promise<{ blob: Blob; note: string }> {
  const drawing = await drawing_of(viewer, options, () => options.dpi / 72, signal);
  const { layout, picture } = drawing;
  if (options.format === "svg") {
    const sheet = new SvgSheet(layout.width, layout.height);
    draw(sheet, viewer, options, drawing, () => picture.outline!(sheet, layout));
    return { blob: new Blob([sheet.document()], { type: "image/svg+xml" }), note: picture.note };
  }
  const plain = await png_of(on_canvas(viewer, options, drawing));
  const png = with_density(new Uint8Array(await plain.arrayBuffer()), options.dpi);
  return { blob: new Blob([png], { type: "image/png" }), note: picture.note };
}
