// The views as a picture for a paper or a mail, with a title above and a legend below.
import { png_of, save_blob } from "../base/download";
import { about, coordinate, product } from "../base/format";
import { AXIS_NAMES } from "../base/grid";
import { css_color } from "../base/materials";
import type { Viewer } from "../state/viewer";
import { snapshot } from "./snapshot";

const MARGIN = 16; // CSS pixels, as are all lengths below
const LINE = 20;
const FONT = "system-ui, -apple-system, 'Segoe UI', sans-serif";

interface Entry {
  color: string;
  name: string;
  left: number;
  top: number;
}

// Places the legend's entries from left to right, in as many lines as they need.
function laid_out(viewer: Viewer, width: number, measure: (text: string) => number): { entries: Entry[]; height: number } {
  const entries: Entry[] = [];
  let left = MARGIN;
  let top = 0;
  viewer.looks.value.forEach((look, id) => {
    if (!look.visible || look.opacity === 0) return;
    const { name } = viewer.info.materials[id]!;
    const wide = 18 + measure(name) + 18;
    if (left + wide > width - MARGIN && left > MARGIN) {
      left = MARGIN;
      top += LINE;
    }
    entries.push({ color: css_color(look), name, left, top });
    left += wide;
  });
  return { entries, height: entries.length ? top + LINE : 0 };
}

function place_text(viewer: Viewer): string {
  const where = viewer.cell.value.map((i, d) => {
    const axis = viewer.axes[d as 0 | 1 | 2];
    return `${AXIS_NAMES[d]} = ${coordinate(axis.centre(i), axis.width(i))}`;
  });
  return `${where.join(", ")} ${viewer.units}`;
}

function framed_snapshot(viewer: Viewer): HTMLCanvasElement {
  const ratio = Math.max(devicePixelRatio, 2);
  const views = snapshot(viewer, ratio);
  const style = getComputedStyle(document.documentElement);
  const color = (name: string) => style.getPropertyValue(name);
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d")!;
  const width = views.width / ratio;
  context.font = `12px ${FONT}`;
  const legend = laid_out(viewer, width, (text) => context.measureText(text).width);
  const head = 44;
  canvas.width = views.width;
  canvas.height = Math.round(views.height + ratio * (head + legend.height + (legend.height ? MARGIN : 0)));
  context.scale(ratio, ratio);
  context.fillStyle = color("--surface");
  context.fillRect(0, 0, width, canvas.height / ratio);
  context.textBaseline = "middle";
  context.fillStyle = color("--text");
  context.font = `600 15px ${FONT}`;
  context.fillText(viewer.info.id, MARGIN, head / 2);
  const name_width = context.measureText(viewer.info.id).width;
  context.font = `12px ${FONT}`;
  context.fillStyle = color("--soft");
  context.fillText(`${about(product(viewer.cells))} cells    ${place_text(viewer)}`, MARGIN + name_width + 14, head / 2 + 1);
  context.drawImage(views, 0, head, width, views.height / ratio);
  const below = head + views.height / ratio + MARGIN / 2;
  for (const entry of legend.entries) {
    const middle = below + entry.top + LINE / 2;
    context.fillStyle = entry.color;
    context.fillRect(entry.left, middle - 6, 12, 12);
    context.strokeStyle = color("--line-strong");
    context.strokeRect(entry.left + 0.5, middle - 5.5, 11, 11);
    context.fillStyle = color("--text");
    context.fillText(entry.name, entry.left + 18, middle + 0.5);
  }
  return canvas;
}

export async function save_picture(viewer: Viewer): Promise<void> {
  save_blob(await png_of(framed_snapshot(viewer)), `${viewer.info.id}.png`);
}
