// The overview as part of a saved picture: its ground, what WebGL has drawn, and the numbers, knobs, lengths and triad, which
// are elements of the page.
import type { Rgba } from "./space/lines";

const css = ([r, g, b, a]: Rgba) => `rgb(${255 * r} ${255 * g} ${255 * b} / ${a})`;

// As in overview.css.
function draw_ground(context: CanvasRenderingContext2D, { width, height }: DOMRect, ground: readonly Rgba[]): void {
  const gradient = context.createRadialGradient(0, 0, 0, 0, 0, 1);
  [0, 0.55, 1].forEach((at, i) => gradient.addColorStop(at, css(ground[i]!)));
  context.save();
  context.translate(0.5 * width, 0.35 * height);
  context.scale(1.2 * width, height);
  context.fillStyle = gradient;
  context.fillRect(-1, -1, 2, 2);
  context.restore();
}

function draw_element(context: CanvasRenderingContext2D, frame: DOMRect, element: HTMLElement): void {
  const box = element.getBoundingClientRect();
  const style = getComputedStyle(element);
  const [x, y] = [box.left - frame.left + box.width / 2, box.top - frame.top + box.height / 2];
  if (element.matches(".overview-length")) {
    context.beginPath();
    context.roundRect(x - box.width / 2, y - box.height / 2, box.width, box.height, 4);
    context.fillStyle = style.backgroundColor;
    context.fill();
  } else if (!element.matches(".overview-number")) {
    const border = Number.parseFloat(style.borderTopWidth);
    context.beginPath();
    context.arc(x, y, (box.width - border) / 2, 0, 2 * Math.PI);
    context.fillStyle = style.backgroundColor;
    context.fill();
    context.strokeStyle = style.borderTopColor;
    context.lineWidth = border;
    if (border > 0) context.stroke();
  }
  context.fillStyle = style.color;
  context.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
  context.fillText(element.textContent, x, y);
}

// From the middle of the triad to the end that follows it.
function draw_arm(context: CanvasRenderingContext2D, frame: DOMRect, arm: HTMLElement): void {
  const [from, to] = [arm.parentElement!, arm.nextElementSibling!].map((element) => element.getBoundingClientRect());
  context.beginPath();
  context.moveTo(from!.left - frame.left, from!.top - frame.top);
  context.lineTo(to!.left + to!.width / 2 - frame.left, to!.top + to!.height / 2 - frame.top);
  context.lineWidth = 2;
  context.strokeStyle = getComputedStyle(arm).backgroundColor;
  context.stroke();
}

// Draws in CSS pixels from the upper left corner of the overview. REQUIRES: the canvas was drawn in the same task.
export function draw_picture(context: CanvasRenderingContext2D, root: HTMLElement, canvas: HTMLCanvasElement, ground: readonly Rgba[]): void {
  const frame = root.getBoundingClientRect();
  draw_ground(context, frame, ground);
  context.imageSmoothingEnabled = true;
  context.drawImage(canvas, 0, 0, frame.width, frame.height);
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (const element of root.querySelectorAll<HTMLElement>(".overview-number:not([hidden]), .overview-knob:not([hidden]), .overview-length"))
    draw_element(context, frame, element);
  const triad = [...root.querySelectorAll<HTMLElement>(".overview-arm, .overview-end")].sort(
    (a, b) => Number(a.style.zIndex) - Number(b.style.zIndex),
  );
  for (const element of triad) {
    if (element.matches(".overview-arm")) draw_arm(context, frame, element);
    else if (element.style.visibility !== "hidden") draw_element(context, frame, element.firstElementChild as HTMLElement);
  }
}
