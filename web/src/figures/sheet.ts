// What a figure is drawn on: a canvas or an SVG document. Lengths are points, of which an inch has 72, from the upper left corner.
export interface TextStyle {
  readonly size: number;
  readonly bold?: boolean;
  readonly align?: "left" | "center" | "right";
  readonly upright?: boolean; // turned by a quarter, read from below
  readonly color: string;
}

export interface Box {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export interface Sheet {
  fill(box: Box, color: string, opacity?: number): void;
  frame(box: Box, color: string, width: number): void;
  line(x0: number, y0: number, x1: number, y1: number, color: string, width: number): void;
  text(text: string, x: number, y: number, style: TextStyle): void; // y is the middle of the line
}

export const FONT = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";
export const font_of = ({ size, bold }: Pick<TextStyle, "size" | "bold">): string => `${bold ? "600 " : ""}${size}px ${FONT}`;

// The width of a text.
export function text_width(text: string, style: Pick<TextStyle, "size" | "bold">): number {
  const context = (measuring ??= document.createElement("canvas").getContext("2d")!);
  context.font = font_of(style);
  return context.measureText(text).width;
}
let measuring: CanvasRenderingContext2D | null = null;
