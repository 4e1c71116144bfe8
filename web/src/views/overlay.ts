// What is drawn above the cells of one view. It has a canvas of its own, so that no cells are painted when the
// crosshair moves.
import type { Box } from "../state/viewer";
import { draw_border, draw_cell_lines, draw_crosshair, draw_rulers, draw_scale_bar, draw_smallest_cells } from "./overlay_axes";
import { draw_box, draw_cut, draw_found, draw_markers, draw_measures, draw_pin } from "./overlay_marks";
import { Pen } from "./drawing/pen";
import type { Scene, View } from "./view";

// Everything that an overlay depends on. It is compared by identity.
function inputs_of({ viewer, ink, ratio }: Scene, view: View, draft: Box | null): unknown[] {
  const v = viewer;
  const signals = [v.cell, v.show_axes, v.show_scale, v.show_lines, v.show_leaves, v.box, v.measures, v.chosen, v.markers, v.isolated, v.pinned, v.cut];
  return [view.camera, view.level, ink, ratio, draft, ...signals.map((signal) => signal.value)];
}

const last_inputs = new WeakMap<View, unknown[]>();

// Draws the overlay if anything has changed, and says whether it did. `draft` is a box that is being drawn.
export function draw_overlay(scene: Scene, view: View, draft: Box | null): boolean {
  const inputs = inputs_of(scene, view, draft);
  const last = last_inputs.get(view);
  if (last && inputs.every((input, i) => input === last[i])) return false;
  last_inputs.set(view, inputs);
  const { ratio } = scene;
  const [width, height] = [Math.round(view.width * ratio), Math.round(view.height * ratio)];
  const context = view.overlay.getContext("2d")!;
  if (view.overlay.width !== width || view.overlay.height !== height) {
    view.overlay.width = width;
    view.overlay.height = height;
  }
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, width, height);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  draw_marks(new Pen(context, view.camera!, scene.viewer, scene.ink), view.level, draft);
  return true;
}

// Draws in CSS pixels, whatever the context's scale is: saved pictures are finer than the screen.
export function draw_marks(pen: Pen, level: number, draft: Box | null = null): void {
  const { viewer } = pen;
  if (viewer.show_lines.value && !viewer.show_leaves.value) draw_cell_lines(pen);
  draw_border(pen);
  draw_box(pen, draft ?? viewer.box.value);
  if (viewer.show_axes.value) {
    draw_crosshair(pen);
    draw_rulers(pen); // their labels interrupt the lines
  }
  draw_cut(pen);
  draw_pin(pen);
  draw_markers(pen, level);
  draw_found(pen);
  draw_measures(pen);
  if (viewer.show_lines.value) draw_smallest_cells(pen);
  if (viewer.show_scale.value) draw_scale_bar(pen);
}
