// The views as they are, as one picture. Overlays are drawn anew, so that they are as fine as the picture; cells are whole squares.
import { AXIS_NAMES, type AxisIndex } from "../api";
import { coordinate } from "../format";
import type { Viewer } from "../viewer";
import { Camera } from "./camera";
import { draw_marks } from "./overlay";
import { FONT, Pen } from "./pen";
import { type Stage, stage_of } from "./stage";

export interface SnapshotOptions {
  readonly ratio?: number; // pixels of the picture a CSS pixel; the screen's when left out
}

export async function snapshot(viewer: Viewer, options: SnapshotOptions = {}): Promise<HTMLCanvasElement> {
  const stage = stage_of(viewer);
  const host = document.querySelector<HTMLElement>(".views");
  if (!stage || !host) throw new Error("there are no views to make a picture of");
  const ratio = options.ratio ?? devicePixelRatio;
  const frame = host.getBoundingClientRect();
  const out = document.createElement("canvas");
  out.width = Math.round(frame.width * ratio);
  out.height = Math.round(frame.height * ratio);
  const context = out.getContext("2d")!;
  const style = getComputedStyle(host);
  context.fillStyle = style.getPropertyValue("--view-gap");
  context.fillRect(0, 0, out.width, out.height);
  for (const panel of host.querySelectorAll<HTMLElement>(".view-panel:not([hidden])")) {
    const body = panel.querySelector<HTMLElement>(".view-body, .view-overview")!;
    const [box, area] = [panel.getBoundingClientRect(), body.getBoundingClientRect()];
    context.setTransform(ratio, 0, 0, ratio, (box.left - frame.left) * ratio, (box.top - frame.top) * ratio);
    context.fillStyle = style.getPropertyValue("--view-outside");
    context.fillRect(0, 0, box.width, box.height);
    // The bar below a slice is left out: its place is the picture's.
    context.save();
    context.beginPath();
    context.rect(0, 0, box.width, box.height);
    context.clip();
    context.translate(area.left - box.left, area.top - box.top + (box.height - area.height) / 2);
    const axis = (AXIS_NAMES as readonly string[]).indexOf(panel.dataset.view!);
    if (axis >= 0) draw_slice(context, stage, axis as AxisIndex, ratio);
    else draw_overview(context, body);
    context.restore();
    if (axis >= 0) draw_title(context, viewer, axis as AxisIndex, style);
  }
  return out;
}

function draw_slice(context: CanvasRenderingContext2D, stage: Stage, axis: AxisIndex, ratio: number): void {
  const view = stage.views[axis];
  const scene = stage.scene(ratio);
  if (!view.visible || !scene) return;
  const { viewer } = stage;
  context.imageSmoothingEnabled = false;
  context.drawImage(view.cells, 0, 0, view.width, view.height);
  const camera = new Camera(axis, viewer.axes, view.width, view.height, ratio, viewer.centre.value, viewer.zoom.value);
  draw_marks(new Pen(context, camera, viewer, scene.ink), view.level);
}

// Its canvas is empty but in the frame that draws it: it draws when it is told to.
function draw_overview(context: CanvasRenderingContext2D, body: HTMLElement): void {
  body.dispatchEvent(new Event("draw"));
  const from = body.getBoundingClientRect();
  context.imageSmoothingEnabled = true;
  for (const canvas of body.querySelectorAll("canvas")) {
    const at = canvas.getBoundingClientRect();
    if (canvas.width > 0 && at.width > 0) context.drawImage(canvas, at.left - from.left, at.top - from.top, at.width, at.height);
  }
}

function draw_title(context: CanvasRenderingContext2D, viewer: Viewer, axis: AxisIndex, style: CSSStyleDeclaration): void {
  const a = viewer.axes[axis];
  const text = `${AXIS_NAMES[axis]} = ${coordinate(a.centre(viewer.cell.value[axis]), (a.max - a.min) / a.cells)} ${viewer.units}`;
  context.font = `600 ${FONT}`;
  context.fillStyle = style.getPropertyValue("--view-plate");
  context.beginPath();
  context.roundRect(8, 8, context.measureText(text).width + 16, 24, 4);
  context.fill();
  context.fillStyle = style.getPropertyValue(`--view-${AXIS_NAMES[axis]}`);
  context.textAlign = "left";
  context.textBaseline = "middle";
  context.fillText(text, 16, 20.5);
}
