// A figure on a canvas.
import { type Box, type Sheet, type TextStyle, font_of } from "./sheet";

export class CanvasSheet implements Sheet {
  readonly canvas = document.createElement("canvas");
  readonly context: CanvasRenderingContext2D;

  // `scale`: pixels per point.
  constructor(
    width: number,
    height: number,
    readonly scale: number,
  ) {
    this.canvas.width = Math.round(width * scale);
    this.canvas.height = Math.round(height * scale);
    this.context = this.canvas.getContext("2d")!;
    this.context.scale(scale, scale);
  }

  fill({ x, y, width, height }: Box, color: string, opacity = 1): void {
    this.context.globalAlpha = opacity;
    this.context.fillStyle = color;
    this.context.fillRect(x, y, width, height);
    this.context.globalAlpha = 1;
  }
  frame({ x, y, width, height }: Box, color: string, line: number): void {
    this.context.strokeStyle = color;
    this.context.lineWidth = line;
    this.context.strokeRect(x, y, width, height);
  }
  line(x0: number, y0: number, x1: number, y1: number, color: string, width: number): void {
    const c = this.context;
    c.strokeStyle = color;
    c.lineWidth = width;
    c.beginPath();
    c.moveTo(x0, y0);
    c.lineTo(x1, y1);
    c.stroke();
  }
  text(text: string, x: number, y: number, style: TextStyle): void {
    const c = this.context;
    c.save();
    c.translate(x, y);
    if (style.upright) c.rotate(-Math.PI / 2);
    c.font = font_of(style);
    c.fillStyle = style.color;
    c.textAlign = style.align ?? "left";
    c.textBaseline = "middle";
    c.fillText(text, 0, 0);
    c.restore();
  }
  // Pixels whose upper left corner lies at a point, one for each pixel of the canvas.
  image(image: ImageData, x: number, y: number): void {
    const picture = new OffscreenCanvas(image.width, image.height);
    picture.getContext("2d")!.putImageData(image, 0, 0);
    this.context.save();
    this.context.resetTransform();
    this.context.drawImage(picture, Math.round(x * this.scale), Math.round(y * this.scale));
    this.context.restore();
  }
}
