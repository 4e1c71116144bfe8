// Colours what is seen. What is clear lies in a layer of its own, so that what is behind it is known too; for each pixel
// the layers are laid over each other from far to near. Pure.
import { ADDED, OWN, type Sights } from "./sights";

export type Substance = "solid" | "clear" | "glass" | "faint";
export const VEILS: readonly Substance[] = ["solid", "clear", "glass", "faint"];

// How much glass hides of what is behind it: the share where it faces the eye, and where it is met at a glancing angle. Glass has as much colour
// where it faces the eye that its hue is known on light and on dark ground; what is faint has edges and little else.
const GLASS = { facing: 0.4, glancing: 0.88 };
const FAINT = { facing: 0.05, glancing: 0.4 };

// What can't be read is striped, as in slices.
export const STRIPES = [[194, 65, 12], [255, 255, 255]] as const;
const STRIPE = 4; // pixels

// How each label looks. After the last one there are both stripes of what can't be read.
export interface Palette {
  readonly squares: Float32Array; // of the colour's three parts, 0 to 1
  readonly opacity: Float32Array; // 0 to 1
  readonly veil: Uint8Array; // what it is made of, as a place in VEILS
  readonly damaged: number; // the label of what can't be read
}

// Of a substance, by the cosine of the angle between the normal and the line of sight.
export function cover_of(substance: Substance, cosine: number): number {
  if (substance === "solid" || substance === "clear") return 1;
  const { facing, glancing } = substance === "glass" ? GLASS : FAINT;
  return facing + (glancing - facing) * (1 - cosine) ** 2;
}

// A part of a picture, or the whole of it. Rows from the top.
export interface Colored {
  readonly width: number;
  readonly height: number;
  readonly pixels: Uint8Array; // RGBA, premultiplied
  readonly far: Float32Array; // of the nearest layer; 0: nothing is seen
  readonly label: Uint32Array; // of the nearest layer, plus 1; 0: nothing
}

// The entry of a palette for a label at a pixel of a picture.
function entry_of(label: number, pixel: number, width: number, { damaged }: Palette): number {
  return label < damaged ? label : damaged + ((Math.floor((pixel % width) + pixel / width) / STRIPE) & 1);
}

// Adds a colour to `to`, premultiplied, 0 to 255 each.
function add_color(to: Float64Array, label: number, own: number, added: number, facing: number, { squares, opacity, veil }: Palette, share: number): void {
  if (label === 0) return;
  const l = label - 1;
  const alpha = share * opacity[l]! * cover_of(VEILS[veil[l]!]!, facing / 255);
  const [o, a] = [own / OWN, added / ADDED];
  for (let c = 0; c < 3; ++c) to[c]! += 255 * alpha * Math.sqrt(Math.min(squares[3 * l + c]! * o + a, 1));
  to[3]! += 255 * alpha;
}

// One layer, as premultiplied colours.
function color_layer(sights: Sights, palette: Palette): Uint8Array {
  const { label, own, added, facing, edges } = sights;
  const out = new Uint8Array(4 * label.length);
  const sum = new Float64Array(4);
  const code = (of: number, pixel: number) => (of === 0 ? 0 : 1 + entry_of(of - 1, pixel, sights.width, palette));
  const put = (at: number) => {
    for (let c = 0; c < 4; ++c) out[4 * at + c] = Math.round(sum[c]!);
    sum.fill(0);
  };
  for (let i = 0; i < label.length; ++i) {
    if (label[i] === 0) continue;
    add_color(sum, code(label[i]!, i), own[i]!, added[i]!, facing[i]!, palette, 1);
    put(i);
  }
  edges.at.forEach((at, e) => {
    for (let i = 4 * e; i < 4 * e + 4; ++i) add_color(sum, code(edges.label[i]!, at), edges.own[i]!, edges.added[i]!, edges.facing[i]!, palette, 0.25);
    put(at);
  });
  return out;
}

// All layers show the same pixels. REQUIRES: there is one at least.
export function compose(layers: readonly Sights[], palette: Palette): Colored {
  const [first, ...rest] = layers;
  const { width, height } = first!;
  if (rest.length === 0) return { width, height, pixels: color_layer(first!, palette), far: first!.far, label: Uint32Array.from(first!.label) };
  const colors = layers.map((layer) => color_layer(layer, palette));
  const pixels = new Uint8Array(4 * width * height);
  const far = new Float32Array(width * height);
  const label = new Uint32Array(width * height);
  const order = layers.map((_, i) => i);
  const behind = (i: number, pixel: number) => layers[i]!.far[pixel]! || Infinity; // an edge of what is not seen in the middle
  for (let p = 0; p < width * height; ++p) {
    order.sort((a, b) => behind(a, p) - behind(b, p));
    let left = 1; // of the light from behind
    for (const i of order) {
      const color = colors[i]!;
      for (let c = 0; c < 4; ++c) pixels[4 * p + c]! += Math.round(left * color[4 * p + c]!);
      if (far[p] === 0) {
        far[p] = layers[i]!.far[p]!;
        label[p] = layers[i]!.label[p]!;
      }
      left *= 1 - color[4 * p + 3]! / 255;
      if (left < 1 / 512) break;
    }
  }
  return { width, height, pixels, far, label };
}
