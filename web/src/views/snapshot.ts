// The views as they are, as one picture: cells, overlays, titles, and a legend of the materials below.
import { AXIS_NAMES } from "../api";
import { coordinate } from "../format";
import { css_color } from "../materials";
import type { Viewer } from "../viewer";
import { unit_name } from "./lengths";
import { FONT } from "./pen";

export interface SnapshotOptions {
  readonly legend?: boolean; // true when left out
}

const ROW = 26; // CSS pixels of the legend
const SWATCH = 14;

interface Swatch {
  readonly name: string;
  readonly color: string;
  readonly width: number;
}

// Rows of the legend that fit into `most` CSS pixels.
function legend_rows(context: CanvasRenderingContext2D, viewer: Viewer, most: number): Swatch[][] {
  const rows: Swatch[][] = [[]];
  let used = 0;
  viewer.looks.value.forEach((look, id) => {
    if (!look.visible || look.opacity === 0) return;
    const name = viewer.info.materials[id]!.name;
    const width = SWATCH + 6 + context.measureText(name).width + 20;
    if (used > 0 && used + width > most) {
      rows.push([]);
      used = 0;
    }
    used += width;
    rows[rows.length - 1]!.push({ name, color: css_color(look), width });
  });
  return rows.filter((row) => row.length > 0);
}

export async function snapshot(viewer: Viewer, options: SnapshotOptions = {}): Promise<HTMLCanvasElement> {
  const host = document.querySelector<HTMLElement>(".views");
  if (!host) throw new Error("there are no views to make a picture of");
  const style = getComputedStyle(host);
  const color = (name: string) => style.getPropertyValue(`--view-${name}`);
  const frame = host.getBoundingClientRect();
  const ratio = Math.max(devicePixelRatio, 1);
  const out = document.createElement("canvas");
  const context = out.getContext("2d")!;
  context.font = FONT;
  const rows = options.legend === false ? [] : legend_rows(context, viewer, frame.width - 24);
  out.width = Math.round(frame.width * ratio);
  out.height = Math.round((frame.height + (rows.length ? rows.length * ROW + 12 : 0)) * ratio);
  context.scale(ratio, ratio);
  context.fillStyle = color("bar");
  context.fillRect(0, 0, frame.width, out.height / ratio);
  context.fillStyle = color("gap");
  context.fillRect(0, 0, frame.width, frame.height);
  context.imageSmoothingEnabled = false;
  // The overview draws when it is asked to: its pixels last until the frame ends.
  host.querySelector(".view-overview")?.dispatchEvent(new Event("teracell-draw"));
  for (const panel of host.querySelectorAll<HTMLElement>(".view-panel:not([hidden])")) {
    const box = panel.getBoundingClientRect();
    context.fillStyle = color("outside");
    context.fillRect(box.left - frame.left, box.top - frame.top, box.width, box.height);
    for (const canvas of panel.querySelectorAll("canvas")) {
      const at = canvas.getBoundingClientRect();
      if (canvas.width > 0 && at.width > 0) context.drawImage(canvas, at.left - frame.left, at.top - frame.top, at.width, at.height);
    }
    draw_title(context, viewer, panel, box.left - frame.left, box.top - frame.top, color);
  }
  context.font = FONT;
  context.textAlign = "left";
  context.textBaseline = "middle";
  rows.forEach((row, r) => {
    const y = frame.height + 6 + (r + 0.5) * ROW;
    let x = 12;
    for (const swatch of row) {
      context.fillStyle = swatch.color;
      context.fillRect(x, y - SWATCH / 2, SWATCH, SWATCH);
      context.strokeStyle = color("border");
      context.strokeRect(x + 0.5, y - SWATCH / 2 + 0.5, SWATCH - 1, SWATCH - 1);
      context.fillStyle = color("text");
      context.fillText(swatch.name, x + SWATCH + 6, y + 0.5);
      x += swatch.width;
    }
  });
  return out;
}

function draw_title(context: CanvasRenderingContext2D, viewer: Viewer, panel: HTMLElement, left: number, top: number, color: (name: string) => string): void {
  const axis = (AXIS_NAMES as readonly string[]).indexOf(panel.dataset.view ?? "") as 0 | 1 | 2 | -1;
  if (axis < 0) return;
  const a = viewer.axes[axis as 0 | 1 | 2];
  const slice = viewer.cell.value[axis as 0 | 1 | 2];
  const text = `${AXIS_NAMES[axis as 0 | 1 | 2]} = ${coordinate(a.centre(slice), (a.max - a.min) / a.cells)} ${unit_name(viewer.info.units)}`;
  context.font = `600 ${FONT}`;
  const width = context.measureText(text).width + 16;
  context.fillStyle = color("plate");
  context.beginPath();
  context.roundRect(left + 8, top + 8, width, 24, 6);
  context.fill();
  context.fillStyle = color(AXIS_NAMES[axis as 0 | 1 | 2]);
  context.textAlign = "left";
  context.textBaseline = "middle";
  context.fillText(text, left + 16, top + 20.5);
}
