// What is seen from somewhere, as a picture of any size, which comes in parts.
import { type Part, parts_of } from "../base/picture_parts";
import { type Colored, compose } from "../overview/sight/compose";
import { layers_of, palette_of } from "../overview/sight/layers";
import { PART, fetch_layers, sight_of } from "../overview/sight/query";
import { space_of } from "../overview/space/space";
import { get_patiently } from "../server/api";
import type { Viewer } from "../state/viewer";

const [MOST, LONGEST] = [2 ** 26, 2 ** 14]; // pixels of a whole picture of which the server shows parts, and of its sides

// From where: what the server is asked for a whole picture of some size, and whether that is in perspective.
export interface Look {
  readonly perspective: boolean;
  query(width: number, height: number): string;
}

// By what the sides of a picture are to be multiplied so that it can be made; 1 as a rule.
export const makeable = (width: number, height: number): number => Math.min(1, Math.sqrt(MOST / (width * height)), LONGEST / width, LONGEST / height);

export const note_of = (fewer: number, pixels: number): string =>
  fewer < 1 ? `Drawn with ${pixels} pixels, the most that are made, and enlarged.` : "Cells of at most a quarter of a pixel.";

async function fetch_part(viewer: Viewer, look: Look, width: number, height: number, part: Part, signal: AbortSignal): Promise<Colored> {
  const sight = sight_of(viewer);
  const query = `${look.query(width, height)}&window=${part.x0},${part.y0},${part.x1},${part.y1}`;
  const sights = await fetch_layers(viewer, space_of(viewer.axes), layers_of(sight), query, (address) => get_patiently(address, signal), look.perspective);
  return compose(sights, palette_of(sight));
}

// Where something is seen in a picture of few pixels.
export async function content_of(viewer: Viewer, look: Look, width: number, height: number, signal: AbortSignal): Promise<Part | null> {
  const { label } = await fetch_part(viewer, look, width, height, { x0: 0, y0: 0, x1: width, y1: height }, signal);
  let [x0, y0, x1, y1] = [width, height, 0, 0];
  label.forEach((seen, i) => {
    if (seen === 0) return;
    const [x, y] = [i % width, Math.floor(i / width)];
    [x0, y0, x1, y1] = [Math.min(x0, x), Math.min(y0, y), Math.max(x1, x + 1), Math.max(y1, y + 1)];
  });
  return x0 < x1 ? { x0, y0, x1, y1 } : null;
}

// Premultiplied pixels as an image has them.
function image_of(part: Colored): ImageData {
  const out = new ImageData(part.width, part.height);
  for (let i = 0; i < out.data.length; i += 4) {
    const alpha = part.pixels[i + 3]!;
    for (let c = 0; c < 3; ++c) out.data[i + c] = alpha === 0 ? 0 : (255 * part.pixels[i + c]!) / alpha;
    out.data[i + 3] = alpha;
  }
  return out;
}

// A part of a picture, and the labels that are seen in it, ascending.
export async function fetch_picture(viewer: Viewer, look: Look, width: number, height: number, { x0, y0, x1, y1 }: Part, signal: AbortSignal) {
  const picture = new OffscreenCanvas(x1 - x0, y1 - y0);
  const labels = new Set<number>();
  const context = picture.getContext("2d")!;
  for (const p of parts_of(picture.width, picture.height, PART)) {
    const came = await fetch_part(viewer, look, width, height, { x0: x0 + p.x0, y0: y0 + p.y0, x1: x0 + p.x1, y1: y0 + p.y1 }, signal);
    for (const label of came.label) if (label > 0) labels.add(label - 1);
    context.putImageData(image_of(came), p.x0, p.y0);
  }
  return { picture, labels: [...labels].sort((a, b) => a - b) };
}
