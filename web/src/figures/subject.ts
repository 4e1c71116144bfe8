// What a figure is made of: a slice, the view in three dimensions, or the domain from the end of an axis. Each knows how to get what a picture of some width needs.
import type { Axis } from "../base/axis";
import type { Layout, Scale } from "./layout";
import type { CanvasSheet } from "./canvas_sheet";
import type { SvgSheet } from "./svg_sheet";

// A picture that has come.
export interface Picture {
  readonly labels: readonly number[]; // that are seen in it
  readonly note: string; // how exact it is
  paint(sheet: CanvasSheet, layout: Layout): void;
  outline?(sheet: SvgSheet, layout: Layout): void; // as shapes
}

export interface Subject {
  readonly aspect: number; // height divided by width
  readonly axes: readonly [Scale, Scale] | null;
  readonly planes: readonly [Axis, Axis] | null; // between which its cells lie
  readonly length: number | null; // of the width, for a scale bar; null: in perspective there is none
  // `pixels`: of the width. With `shapes`, the picture can be outlined.
  fetch(pixels: number, shapes: boolean, signal: AbortSignal): Promise<Picture>;
}
