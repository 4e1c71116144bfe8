// A slice as the subject of a figure.
import { FRAMES } from "../base/axis";
import { AXIS_NAMES, type AxisIndex } from "../base/grid";
import type { LabelLook } from "../base/materials";
import type { Viewer } from "../state/viewer";
import { Palette, type Rgb } from "../tiles/sets";
import { joined } from "./areas";
import type { FigureOptions } from "./options";
import { type SliceCells, type Window, content_of, fetch_cells, for_each_run, labels_in, pixels_over, whole_window } from "./slice_cells";
import type { Picture, Subject } from "./subject";

const MOST_SHAPES = 200_000;
const ROUGHLY = 1000; // pixels in which the content is looked for
const MARGIN = 0.03; // around the content, as a share of its longer side, as far as the domain reaches

// What the view shows on the screen; the whole slice where no view shows it.
function screen_window(viewer: Viewer, axis: AxisIndex): Window {
  const { u, v } = FRAMES[axis];
  const [across, up] = [viewer.axes[u], viewer.axes[v]];
  const size = viewer.views.find((view) => view.axis === axis);
  const zoom = viewer.zoom.peek();
  if (!size || zoom === 0) return whole_window(across, up);
  const centre = viewer.centre.peek();
  const part = (middle: number, length: number) => [middle - length / 2 / zoom, middle + length / 2 / zoom] as const;
  const [[u0, u1], [v0, v1]] = [part(centre[u], size.width), part(centre[v], size.height)];
  return { u0: across.inside(u0), u1: across.inside(u1), v0: up.inside(v0), v1: up.inside(v1) };
}

async function window_of(viewer: Viewer, axis: AxisIndex, crop: FigureOptions["crop"], looks: readonly LabelLook[], signal: AbortSignal): Promise<Window> {
  const { u, v } = FRAMES[axis];
  const [across, up] = [viewer.axes[u], viewer.axes[v]];
  const whole = whole_window(across, up);
  if (crop === "whole") return whole;
  const screen = screen_window(viewer, axis);
  if (crop === "screen" && screen.u1 > screen.u0 && screen.v1 > screen.v0) return screen;
  const content = content_of(await fetch_cells(viewer, axis, whole, ROUGHLY, signal), looks);
  if (!content) return whole;
  const { u0, u1, v0, v1 } = content;
  const margin = MARGIN * Math.max(u1 - u0, v1 - v0);
  return { u0: across.inside(u0 - margin), u1: across.inside(u1 + margin), v0: up.inside(v0 - margin), v1: up.inside(v1 + margin) };
}

// Fetches cells that are as fine as the picture, or, for shapes, coarser ones if there would be too many.
async function fetch_shapes(viewer: Viewer, axis: AxisIndex, window: Window, pixels: number, looks: readonly LabelLook[], signal: AbortSignal) {
  for (let width = pixels; ; width /= 2) {
    const cells = await fetch_cells(viewer, axis, window, width, signal);
    const colors = new Map<number, string>();
    const color_of = (set: number): string => {
      let color = colors.get(set);
      if (color === undefined) colors.set(set, (color = cells.sets.color(set, looks).join(" ")));
      return color;
    };
    const runs: { key: string; u0: number; u1: number; v0: number; v1: number }[] = [];
    for_each_run(cells, cells.camera.seen(), (set, run) => {
      const key = color_of(set);
      if (!key.endsWith(" 0")) runs.push({ ...run, key });
    });
    const areas = joined(runs, MOST_SHAPES);
    if (areas) return { cells, areas };
  }
}

function note_of({ level }: SliceCells, pixels: number): string {
  if (level === 0) return "Every cell is shown.";
  const side = 2 ** level;
  return `Cells of level ${level} (${side} × ${side} × ${side} cells each), as fine as ${Math.round(pixels)} pixels show.`;
}

export async function slice_subject(viewer: Viewer, axis: AxisIndex, options: FigureOptions, ground: Rgb | null, signal: AbortSignal): Promise<Subject> {
  const looks = viewer.shown_looks.peek();
  const window = await window_of(viewer, axis, options.crop, looks, signal);
  const { u, v } = FRAMES[axis];
  const length = window.u1 - window.u0;
  const scale = (d: AxisIndex, low: number, high: number) => ({ name: `${AXIS_NAMES[d]} [${viewer.units}]`, low, high });
  return {
    aspect: (window.v1 - window.v0) / length,
    axes: [scale(u, window.u0, window.u1), scale(v, window.v0, window.v1)],
    planes: [viewer.axes[u], viewer.axes[v]],
    length,
    async fetch(pixels, shapes, abort): Promise<Picture> {
      if (!shapes) {
        const cells = await fetch_cells(viewer, axis, window, pixels, abort);
        const image = pixels_over(cells, new Palette(cells.sets), looks, ground);
        return { labels: labels_in(cells), note: note_of(cells, pixels), paint: (sheet, { plot }) => sheet.image(image, plot.x, plot.y) };
      }
      const { cells, areas } = await fetch_shapes(viewer, axis, window, pixels, looks, abort);
      const { across, up } = cells.camera;
      return {
        labels: labels_in(cells),
        note: cells.level === 0 ? "Every cell is shown." : `Cells of level ${cells.level}: finer ones would be more than ${MOST_SHAPES} shapes, or finer than print.`,
        paint: () => {},
        outline: (sheet, { plot }) => {
          const zoom = plot.width / length;
          const place = (i: number, j: number) => [plot.x + (across.plane(i) - window.u0) * zoom, plot.y + plot.height - (up.plane(j) - window.v0) * zoom] as const;
          sheet.clipped(plot, () => {
            for (const [key, list] of areas) {
              const [r, g, b, a] = key.split(" ").map(Number) as [number, number, number, number];
              sheet.areas(list, `rgb(${r},${g},${b})`, a / 255, place);
            }
          });
        },
      };
    },
  };
}
