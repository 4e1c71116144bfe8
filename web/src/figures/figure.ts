// Makes a figure: gets what its subject needs, lays it out, and draws it.
import { coordinate } from "../base/format";
import { AXIS_NAMES, type AxisIndex, without_overlap } from "../base/grid";
import { png_of } from "../base/download";
import type { Viewer } from "../state/viewer";
import type { Rgb } from "../tiles/sets";
import { length_text, round_length } from "../base/lengths";
import { CanvasSheet } from "./canvas_sheet";
import { type Layout, NARROWEST, type Place, SIZE, TITLE, laid_out, laid_out_together, panel_width, planes_within } from "./layout";
import { type FigureOptions, has_space, points_of } from "./options";
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
    const look = viewer.shown_looks.peek()[label]; // none: it can't be read
    if (!look?.visible || look.opacity === 0 || look.faint) continue;
    const whole = without_overlap(viewer.labels, label);
    const is_overlap = whole !== label && viewer.isolated.peek()?.labels.includes(label);
    const is_own = viewer.body_looks.peek().get(whole)?.color !== undefined;
    const name = is_overlap ? viewer.name_of(label) : is_own ? viewer.name_of(whole) : viewer.info.materials[look.material]!.name;
    entries.set(name, { name, color: `rgb(${look.color.join(",")})`, opacity: look.opacity, order: look.material });
  }
  return [...entries.values()].sort((a, b) => a.order - b.order);
}

// What the figure is called: "stadium-z-27.037m".
export function name_of(viewer: Viewer, { subject, format }: FigureOptions): string {
  if (has_space(subject)) return `${viewer.info.id}-${subject}.${format}`;
  const d = AXIS_NAMES.indexOf(subject) as AxisIndex;
  const [axis, i] = [viewer.axes[d], viewer.cell.peek()[d]];
  const place = axis.centre(i).toFixed(Math.max(0, Math.ceil(-Math.log10(axis.width(i))) + 1));
  return `${viewer.info.id}-${subject}-${place}${viewer.info.units}.${format}`;
}

// A title that says what is shown.
export function standard_title(viewer: Viewer, { subject }: Pick<FigureOptions, "subject">): string {
  return has_space(subject) ? viewer.info.id : `${viewer.info.id}, ${slice_words(viewer, AXIS_NAMES.indexOf(subject) as AxisIndex)}`;
}

function slice_words(viewer: Viewer, axis: AxisIndex): string {
  const [own, i] = [viewer.axes[axis], viewer.cell.value[axis]];
  return `${AXIS_NAMES[axis]} = ${coordinate(own.centre(i), own.width(i))} ${viewer.units}`;
}

// One picture with what stands around it.
function draw_panel(sheet: Sheet, viewer: Viewer, options: FigureOptions, { subject, layout, heading }: Panel, paint: () => void): void {
  const { ink } = COLORS[options.ground];
  const { plot } = layout;
  paint();
  const text = { size: SIZE, color: ink };
  if (layout.title !== null) {
    const size = Math.max(Math.min(heading.size, (heading.size * plot.width) / text_width(heading.text, { size: heading.size, bold: true })), LEAST_TITLE);
    sheet.text(heading.text, plot.x, layout.title, { size, bold: true, color: ink });
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
  if (layout.bar === null || subject.length === null) return;
  const length = round_length(subject.length / BAR);
  const width = (length / subject.length) * plot.width;
  const x = plot.x + plot.width - width;
  sheet.fill({ x, y: layout.bar - 1, width, height: 2 }, ink);
  sheet.text(length_text(length, viewer.info.units), x - 4, layout.bar, { ...text, align: "right" });
}

function draw(sheet: Sheet, viewer: Viewer, options: FigureOptions, drawing: Drawing, paint: (panel: Panel) => void): void {
  const { ground, ink } = COLORS[options.ground];
  if (ground) sheet.fill({ x: 0, y: 0, width: drawing.width, height: drawing.height }, `rgb(${ground.join(",")})`);
  if (drawing.title !== null) {
    const size = Math.max(Math.min(TITLE, (TITLE * drawing.width) / text_width(options.title, { size: TITLE, bold: true })), LEAST_TITLE);
    sheet.text(options.title, 0, drawing.title, { size, bold: true, color: ink });
  }
  for (const panel of drawing.panels) draw_panel(sheet, viewer, options, panel, () => paint(panel));
  for (const { x, y, entry } of drawing.places) {
    const { name, color, opacity } = drawing.legend[entry]!;
    const swatch = { x, y: y - SIZE / 2, width: SIZE, height: SIZE };
    sheet.fill(swatch, color, opacity);
    sheet.frame(swatch, ink, 0.3);
    sheet.text(name, x + SIZE + 4, y, { size: SIZE, color: ink });
  }
}

interface Wanted {
  readonly heading: string;
  readonly subject: Subject;
}

// What stands on the sheet. `points`: the width of each.
async function subjects_of(viewer: Viewer, options: FigureOptions, points: number, signal: AbortSignal): Promise<Wanted[]> {
  const { ground, ink } = COLORS[options.ground];
  const slice = async (axis: AxisIndex): Promise<Wanted> => ({
    heading: slice_words(viewer, axis),
    subject: await slice_subject(viewer, axis, options, ground, signal),
  });
  const space = async (): Promise<Wanted> => {
    const { space_subject } = await import("./space_subject");
    return { heading: "3D, in perspective", subject: await space_subject(viewer, { crop: options.crop, axes: options.axes, points, ink }, signal) };
  };
  const straight = async (axis: AxisIndex): Promise<Wanted> => {
    const { straight_subject } = await import("./straight_subject");
    return { heading: `from +${AXIS_NAMES[axis]}`, subject: await straight_subject(viewer, axis, options.crop, signal) };
  };
  if (options.subject === "3d") return [await space()];
  if (options.subject === "four") return [await slice(2), await slice(0), await slice(1), await space()];
  if (options.subject === "sides") return [await space(), await straight(0), await straight(1), await straight(2)];
  return [await slice(AXIS_NAMES.indexOf(options.subject) as AxisIndex)];
}

const MOST = 64e6; // pixels
const SHAPES = 8192; // pixels across, as fine as which shapes are at most

interface Panel {
  readonly subject: Subject;
  readonly picture: Picture;
  readonly layout: Layout;
  readonly heading: { readonly text: string; readonly size: number };
}

interface Drawing {
  readonly scale: number; // pixels per point
  readonly width: number;
  readonly height: number;
  readonly title: number | null; // the middle of its line, where it is not the heading of the only panel
  readonly panels: readonly Panel[];
  readonly legend: readonly Entry[];
  readonly places: readonly Place[]; // of the legend's entries
}

// `scale_for`: pixels per point, for a layout without its legend. Throws when it would have too many pixels.
async function drawing_of(viewer: Viewer, options: FigureOptions, scale_for: (size: { width: number; height: number }) => number, signal: AbortSignal): Promise<Drawing> {
  const points = points_of(options);
  const count = options.subject === "four" || options.subject === "sides" ? 4 : 1;
  const wanted = await subjects_of(viewer, options, panel_width(points, count), signal);
  const measure = (text: string) => text_width(text, { size: SIZE });
  const titled = options.title !== "";
  const layout_of = (legend: readonly string[]) => {
    const panels = wanted.map(({ subject }) => ({ aspect: subject.aspect, axes: options.axes ? subject.axes : null, bar: options.bar && subject.length !== null }));
    if (panels.length > 1) return laid_out_together(panels, points, titled, legend, measure);
    const only = laid_out({ ...panels[0]!, width: points, title: titled, legend }, measure);
    return { ...only, title: null, panels: [only] };
  };
  const bare = layout_of([]);
  if (bare.panels.some(({ plot }) => plot.width < NARROWEST)) throw new Error("the figure is too narrow for its axes: make it wider, or leave them out");
  const shapes = options.format === "svg";
  const scale = shapes ? Math.min(options.dpi / 72, SHAPES / bare.width, SHAPES / bare.height) : scale_for(bare);
  const [width, height] = [Math.round(bare.width * scale), Math.round(bare.height * scale)];
  if (width * height > MOST) throw new Error(`${width} × ${height} pixels are more than the ${MOST / 1e6} million that can be made`);
  const pictures: Picture[] = [];
  for (const [n, { subject }] of wanted.entries()) pictures.push(await subject.fetch(Math.max(1, Math.round(bare.panels[n]!.plot.width * scale)), shapes, signal));
  const legend = options.legend ? legend_of(viewer, [...new Set(pictures.flatMap(({ labels }) => labels))]) : [];
  const layout = layout_of(legend.map(({ name }) => name));
  const panels = wanted.map(({ subject, heading }, n): Panel => {
    const alone = wanted.length === 1;
    return { subject, picture: pictures[n]!, layout: layout.panels[n]!, heading: { text: alone ? options.title : heading, size: alone ? TITLE : SIZE + 1 } };
  });
  return { scale, width: layout.width, height: layout.height, title: layout.title, panels, legend, places: layout.legend };
}

function on_canvas(viewer: Viewer, options: FigureOptions, drawing: Drawing): HTMLCanvasElement {
  const sheet = new CanvasSheet(drawing.width, drawing.height, drawing.scale);
  draw(sheet, viewer, options, drawing, ({ picture, layout }) => picture.paint(sheet, layout));
  return sheet.canvas;
}

// What the figure will look like, at most this many pixels wide and high, and how many pixels high it will be.
export async function preview_of(viewer: Viewer, options: FigureOptions, most: number, signal: AbortSignal): Promise<{ canvas: HTMLCanvasElement; height: number }> {
  const pixels = { ...options, format: "png" as const };
  const drawing = await drawing_of(viewer, pixels, ({ width, height }) => Math.min(most / width, most / height), signal);
  return { canvas: on_canvas(viewer, pixels, drawing), height: (drawing.height * options.dpi) / 72 };
}

// Throws when it can't be made. REQUIRES: fault_of() finds none in the options.
export async function make_figure(viewer: Viewer, options: FigureOptions, signal: AbortSignal): Promise<{ blob: Blob; note: string }> {
  const drawing = await drawing_of(viewer, options, () => options.dpi / 72, signal);
  const note = [...new Set(drawing.panels.map(({ picture, heading }) => (drawing.panels.length > 1 ? `${heading.text}: ${picture.note}` : picture.note)))].join(" ");
  if (options.format === "svg") {
    const sheet = new SvgSheet(drawing.width, drawing.height);
    draw(sheet, viewer, options, drawing, ({ picture, layout }) => picture.outline!(sheet, layout));
    return { blob: new Blob([sheet.document()], { type: "image/svg+xml" }), note };
  }
  const plain = await png_of(on_canvas(viewer, options, drawing));
  const png = with_density(new Uint8Array(await plain.arrayBuffer()), options.dpi);
  return { blob: new Blob([png], { type: "image/png" }), note };
}
