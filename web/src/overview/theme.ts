// The overview's colours, from custom properties of the page: the style sheet alone decides about light and dark.
import type { Rgba } from "./space/lines";

export interface Theme {
  readonly ground: readonly [Rgba, Rgba, Rgba]; // from its middle to its corners
  readonly edge: Rgba; // of the domain
  readonly axes: readonly [Rgba, Rgba, Rgba];
  readonly crosshair: Rgba;
  readonly box: Rgba;
  readonly marker: Rgba;
  readonly measure: Rgba;
}

// Any CSS colour as four numbers, including one that a custom property computes.
function color_of(context: CanvasRenderingContext2D, text: string): Rgba {
  context.clearRect(0, 0, 1, 1);
  context.fillStyle = "#888";
  context.fillStyle = text.trim();
  context.fillRect(0, 0, 1, 1);
  const [r, g, b, a] = context.getImageData(0, 0, 1, 1).data as unknown as [number, number, number, number];
  return [r / 255, g / 255, b / 255, a / 255];
}

export function read_theme(element: HTMLElement): Theme {
  const style = getComputedStyle(element);
  const context = document.createElement("canvas").getContext("2d", { willReadFrequently: true })!;
  const color = (name: string) => color_of(context, style.getPropertyValue(`--overview-${name}`));
  return {
    ground: [color("inner"), color("middle"), color("outer")],
    edge: color("edge"),
    axes: [color("x"), color("y"), color("z")],
    crosshair: color("crosshair"),
    box: color("box"),
    marker: color("marker"),
    measure: color("measure"),
  };
}
