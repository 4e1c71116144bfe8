// A figure as an SVG document: text stays text, and cells are shapes.
import type { Extent } from "../tiles/place";
import { type Box, FONT, type Sheet, type TextStyle } from "./sheet";

const number = (x: number): string => String(Number(x.toFixed(3)));
const alpha_of = (opacity: number): string => (opacity < 1 ? ` fill-opacity="${number(opacity)}"` : "");
const escaped = (text: string): string => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

export class SvgSheet implements Sheet {
  private readonly parts: string[] = [];

  constructor(
    readonly width: number,
    readonly height: number,
  ) {}

  fill({ x, y, width, height }: Box, color: string, opacity = 1): void {
    const place = `x="${number(x)}" y="${number(y)}" width="${number(width)}" height="${number(height)}"`;
    this.parts.push(`<rect ${place} fill="${color}"${alpha_of(opacity)}/>`);
  }
  frame({ x, y, width, height }: Box, color: string, line: number): void {
    const place = `x="${number(x)}" y="${number(y)}" width="${number(width)}" height="${number(height)}"`;
    this.parts.push(`<rect ${place} fill="none" stroke="${color}" stroke-width="${line}"/>`);
  }
  line(x0: number, y0: number, x1: number, y1: number, color: string, width: number): void {
    this.parts.push(`<path d="M${number(x0)} ${number(y0)}L${number(x1)} ${number(y1)}" stroke="${color}" stroke-width="${width}"/>`);
  }
  text(text: string, x: number, y: number, { size, bold, align = "left", upright, color }: TextStyle): void {
    const anchor = { left: "start", center: "middle", right: "end" }[align];
    const turn = upright ? ` transform="rotate(-90 ${number(x)} ${number(y)})"` : "";
    const weight = bold ? ` font-weight="600"` : "";
    const place = `x="${number(x)}" y="${number(y)}" dy="0.35em" font-size="${size}"${weight} text-anchor="${anchor}"`;
    this.parts.push(`<text ${place} fill="${color}"${turn}>${escaped(text)}</text>`);
  }
  // Rectangles of one colour; `place` gives the corners of cells in points.
  areas(areas: readonly Extent[], color: string, opacity: number, place: (u: number, v: number) => readonly [number, number]): void {
    const shapes = areas.map(({ u0, u1, v0, v1 }) => {
      const [[left, bottom], [right, top]] = [place(u0, v0), place(u1, v1)];
      return `M${number(left)} ${number(top)}H${number(right)}V${number(bottom)}H${number(left)}Z`;
    });
    this.parts.push(`<path fill="${color}"${alpha_of(opacity)} shape-rendering="crispEdges" d="${shapes.join("")}"/>`);
  }
  // Shows what `draw` draws inside a box alone.
  clipped({ x, y, width, height }: Box, draw: () => void): void {
    this.parts.push(
      `<clipPath id="plot"><rect x="${number(x)}" y="${number(y)}" width="${number(width)}" height="${number(height)}"/></clipPath><g clip-path="url(#plot)">`,
    );
    draw();
    this.parts.push("</g>");
  }

  document(): string {
    const [w, h] = [number(this.width), number(this.height)];
    const open = `<svg xmlns="http://www.w3.org/2000/svg" width="${w}pt" height="${h}pt" viewBox="0 0 ${w} ${h}" font-family="${FONT}">`;
    return `<?xml version="1.0" encoding="UTF-8"?>\n${open}\n${this.parts.join("\n")}\n</svg>\n`;
  }
}
