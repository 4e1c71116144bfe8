// The views as one picture. Slices are painted anew for it: they fill their panels, even where a bar covers them on the
// page, and their overlays are as fine as the picture. Cells keep sharp edges.
import { coordinate } from "../base/format";
import { AXIS_NAMES, type AxisIndex } from "../base/grid";
import type { Viewer } from "../state/viewer";
import { draw_marks } from "./overlay";
import { FONT, Pen } from "./drawing/pen";
import { stage_of } from "./stage";
import { type Scene, View } from "./view";

// `ratio`: pixels of the picture per CSS pixel.
export function snapshot(viewer: Viewer, ratio: number): HTMLCanvasElement {
  const stage = stage_of(viewer);
  const host = document.querySelector<HTMLElement>(".views");
  const scene = stage?.scene(devicePixelRatio);
  if (!scene || !host) throw new Error("there are no views to make a picture of");
  const frame = host.getBoundingClientRect();
  const out = document.createElement("canvas");
  out.width = Math.round(frame.width * ratio);
  out.height = Math.round(frame.height * ratio);
  const context = out.getContext("2d")!;
  const style = getComputedStyle(host);
  scene.palette.update(viewer.shown_looks.value, scene.ink.ground, scene.ink.outside);
  context.fillStyle = style.getPropertyValue("--view-gap");
  context.fillRect(0, 0, out.width, out.height);
  for (const panel of host.querySelectorAll<HTMLElement>(".view-panel:not([hidden])")) {
    const box = panel.getBoundingClientRect();
    context.setTransform(ratio, 0, 0, ratio, (box.left - frame.left) * ratio, (box.top - frame.top) * ratio);
    context.fillStyle = style.getPropertyValue("--view-outside");
    context.fillRect(0, 0, box.width, box.height);
    context.save();
    context.beginPath();
    context.rect(0, 0, box.width, box.height);
    context.clip();
    const axis = (AXIS_NAMES as readonly string[]).indexOf(panel.dataset.view!);
    if (axis >= 0) {
      const view = draw_slice(context, scene, axis as AxisIndex, box, ratio);
      draw_title(context, viewer, view, style);
    } else panel.querySelector(".view-overview")!.dispatchEvent(new CustomEvent("draw", { detail: context }));
    context.restore();
  }
  return out;
}

function draw_slice(context: CanvasRenderingContext2D, scene: Scene, axis: AxisIndex, { width, height }: DOMRect, ratio: number): View {
  const view = new View(axis);
  Object.assign(view, { width, height });
  view.look(scene, 0);
  view.paint(scene);
  context.imageSmoothingEnabled = false;
  context.drawImage(view.cells, 0, 0, width, height);
  const { viewer, ink } = scene;
  draw_marks(new Pen(context, view.camera_of(viewer, ratio), viewer, ink), view.level);
  return view;
}

// The title at the top left of a view.
function draw_title(context: CanvasRenderingContext2D, viewer: Viewer, { axis, level }: View, style: CSSStyleDeclaration): void {
  const a = viewer.axes[axis];
  const i = viewer.cell.value[axis];
  const parts = [
    {
      text: `${AXIS_NAMES[axis]} = ${coordinate(a.centre(i), a.plane(i + 1) - a.plane(i))} ${viewer.units}`,
      font: `600 ${FONT}`,
      color: `--view-${AXIS_NAMES[axis]}`,
    },
    ...(level > 0 ? [{ text: `level ${level}`, font: FONT, color: "--view-text" }] : []),
  ];
  const widths = parts.map(({ text, font }) => {
    context.font = font;
    return context.measureText(text).width + 8;
  });
  context.fillStyle = style.getPropertyValue("--view-plate");
  context.beginPath();
  context.roundRect(8, 8, widths.reduce((sum, width) => sum + width, 8), 24, 4);
  context.fill();
  context.textAlign = "left";
  context.textBaseline = "middle";
  let x = 16;
  parts.forEach(({ text, font, color }, i) => {
    context.font = font;
    context.fillStyle = style.getPropertyValue(color);
    context.fillText(text, x, 20.5);
    x += widths[i]!;
  });
}
