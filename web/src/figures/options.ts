// What a figure shows, and how large it is. Pure.
export type Subject = "x" | "y" | "z" | "3d" | "four" | "sides"; // four: the slices and the view in 3D; sides: that view from four directions
export const has_space = (subject: Subject): subject is "3d" | "four" | "sides" => !["x", "y", "z"].includes(subject);
export const UNITS = ["mm", "in", "px"] as const;

export interface FigureOptions {
  readonly subject: Subject;
  readonly format: "png" | "svg"; // a slice alone can be SVG
  readonly width: number;
  readonly unit: (typeof UNITS)[number];
  readonly dpi: number; // dots per inch
  readonly crop: "screen" | "content" | "whole"; // what is on the screen, what isn't clear, or all of it
  readonly ground: "white" | "clear" | "black";
  readonly axes: boolean; // coordinates beside the picture
  readonly lines: boolean; // between cells that are large enough for it
  readonly bar: boolean; // a scale bar
  readonly legend: boolean; // the materials that are seen
  readonly title: string; // may be empty
}

export const STANDARD: FigureOptions = {
  subject: "z",
  format: "png",
  width: 170,
  unit: "mm",
  dpi: 300,
  crop: "content",
  ground: "white",
  axes: true,
  lines: false,
  bar: false,
  legend: true,
  title: "",
};

const POINT = 72; // of an inch
export const [LEAST_DPI, MOST_DPI] = [36, 2400];
const [NARROWEST, WIDEST] = [100, 10_000]; // pixels
const WIDEST_PAGE = 1e4; // points, 3.5 m

// The width in points, of which an inch has 72.
export function points_of({ width, unit, dpi }: FigureOptions): number {
  return unit === "mm" ? (width / 25.4) * POINT : unit === "in" ? width * POINT : (width * POINT) / dpi;
}
export const pixels_of = (options: FigureOptions): number => Math.round((points_of(options) * options.dpi) / POINT);

// Why there can be no figure with these options; null when there can be.
export function fault_of(options: FigureOptions): string | null {
  const { width, dpi, subject, format } = options;
  if (!(dpi >= LEAST_DPI && dpi <= MOST_DPI)) return `Dots per inch: ${LEAST_DPI} to ${MOST_DPI}.`;
  if (!(width > 0)) return "The width must be above 0.";
  if (has_space(subject) && format === "svg") return "The picture in three dimensions is made of pixels: choose PNG.";
  const pixels = pixels_of(options);
  if (format === "svg" && points_of(options) > WIDEST_PAGE) return "The figure would be wider than 3.5 metres.";
  if (format === "svg" || (pixels >= NARROWEST && pixels <= WIDEST)) return null;
  return `The figure would be ${pixels} pixels wide: ${NARROWEST} to ${WIDEST} can be made.`;
}
