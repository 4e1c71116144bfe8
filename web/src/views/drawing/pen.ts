// The pen of the overlays. Each stroke has a halo, so that it is seen on any material.
import { FRAMES, type Frame } from "../../base/axis";
import type { AxisIndex } from "../../base/grid";
import type { Viewer } from "../../state/viewer";
import type { Extent } from "../../tiles/place";
import { HANDLE } from "./box_handles";
import type { Camera } from "./camera";
import type { Ink } from "./ink";

export const FONT = "12px system-ui, sans-serif";

const THIN = 16; // CSS pixels
const ROOM = 6;

interface Rectangle {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}

// What one overlay is drawn with, in CSS pixels.
export class Pen {
  readonly frame: Frame;
  constructor(
    readonly context: CanvasRenderingContext2D,
    readonly camera: Camera,
    readonly viewer: Viewer,
    readonly ink: Ink,
  ) {
    this.frame = FRAMES[camera.axis];
    context.font = FONT;
    context.lineJoin = "round";
  }

  get axis(): AxisIndex {
    return this.camera.axis;
  }

  // The middle of the device pixel at x, where lines of one pixel are sharp.
  crisp(x: number): number {
    return (Math.floor(x * this.camera.ratio) + 0.5) / this.camera.ratio;
  }

  path(points: readonly (readonly [number, number])[], color: string, options: { width?: number; dash?: number[]; close?: boolean } = {}): void {
    const { width = 1.25, dash = [], close = false } = options;
    const c = this.context;
    c.beginPath();
    points.forEach(([x, y], i) => (i === 0 ? c.moveTo(x, y) : c.lineTo(x, y)));
    if (close) c.closePath();
    c.setLineDash(dash);
    c.strokeStyle = this.ink.halo;
    c.lineWidth = width + 2;
    c.stroke();
    c.strokeStyle = color;
    c.lineWidth = width;
    c.stroke();
    c.setLineDash([]);
  }

  // A rectangle of cells of level 0, half open.
  cells(extent: Extent, color: string, options: { width?: number; dash?: number[] } = {}): void {
    this.rectangle(this.camera.place_of(extent), color, options);
  }

  // Where the line around a box is: clear of its cells where these are so thin that it would hide them.
  line_around(extent: Extent): Rectangle & { clear: boolean } {
    const { left, right, top, bottom } = this.camera.place_of(extent);
    const clear = Math.min(right - left, bottom - top) < THIN;
    const room = clear ? ROOM : 0;
    return { left: left - room, right: right + room, top: top - room, bottom: bottom + room, clear };
  }

  rectangle({ left, right, top, bottom }: Rectangle, color: string, options: { width?: number; dash?: number[] } = {}): void {
    // Clipped here, because a dashed line that reaches far outside the canvas costs time.
    const clip = (x: number, most: number) => Math.min(Math.max(this.crisp(x), -16), most + 16);
    const [l, r] = [clip(left, this.camera.width), clip(right, this.camera.width)];
    const [t, b] = [clip(top, this.camera.height), clip(bottom, this.camera.height)];
    this.path([[l, t], [r, t], [r, b], [l, b]], color, { ...options, close: true });
  }

  // What can be dragged.
  handle(x: number, y: number): void {
    const c = this.context;
    c.fillStyle = this.ink.plate;
    c.strokeStyle = this.ink.accent;
    c.lineWidth = 1.5;
    c.beginPath();
    c.rect(x - HANDLE, y - HANDLE, 2 * HANDLE, 2 * HANDLE);
    c.fill();
    c.stroke();
  }

  text(text: string, x: number, y: number, color = this.ink.text, align: CanvasTextAlign = "left", baseline: CanvasTextBaseline = "middle"): void {
    const c = this.context;
    c.textAlign = align;
    c.textBaseline = baseline;
    c.strokeStyle = this.ink.halo;
    c.lineWidth = 3;
    c.strokeText(text, x, y);
    c.fillStyle = color;
    c.fillText(text, x, y);
  }

  // Text that covers the lines below it.
  label(text: string, x: number, y: number, align: CanvasTextAlign = "left", baseline: CanvasTextBaseline = "middle"): void {
    const c = this.context;
    c.textAlign = align;
    c.textBaseline = baseline;
    const {
      actualBoundingBoxLeft: left, actualBoundingBoxRight: right, actualBoundingBoxAscent: up, actualBoundingBoxDescent: down,
    } = c.measureText(text);
    c.fillStyle = this.ink.plate;
    c.beginPath();
    c.roundRect(x - left - 3, y - up - 3, left + right + 6, up + down + 6, 3);
    c.fill();
    c.fillStyle = this.ink.text;
    c.fillText(text, x, y);
  }

  // Text on a small plate, kept inside the view.
  plate(text: string, x: number, y: number, color: string): void {
    const c = this.context;
    const width = c.measureText(text).width + 12;
    const left = Math.min(Math.max(x - width / 2, 4), this.camera.width - width - 4);
    const top = Math.min(Math.max(y - 10, 4), this.camera.height - 24);
    c.fillStyle = this.ink.plate;
    c.strokeStyle = color;
    c.lineWidth = 1;
    c.beginPath();
    c.roundRect(left, top, width, 20, 4);
    c.fill();
    c.stroke();
    c.fillStyle = this.ink.text;
    c.textAlign = "center";
    c.textBaseline = "middle";
    c.fillText(text, left + width / 2, top + 10.5);
  }
}
