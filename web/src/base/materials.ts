// How materials look. A coarse cell holds a set of materials. Its colour is the mean of their colours, weighted by
// their opacity, as in the pictures that the server makes. Only on the page, air weighs less.
import type { Material } from "./grid";

export interface MaterialLook {
  color: readonly [number, number, number]; // sRGB, 0 to 255
  visible: boolean;
  opacity: number; // 0 to 1
}

function parse_color(text: string): [number, number, number, number] {
  const hex = (at: number) => Number.parseInt(text.slice(at, at + 2), 16);
  return [hex(1), hex(3), hex(5), text.length > 7 ? hex(7) : 255];
}

export function initial_looks(materials: readonly Material[]): MaterialLook[] {
  return materials.map((m) => {
    const [r, g, b, a] = parse_color(m.color);
    return { color: [r, g, b], visible: true, opacity: a / 255 };
  });
}

export const hex_color = (look: MaterialLook): string => `#${look.color.map((c) => c.toString(16).padStart(2, "0")).join("")}`;
export const same_look = (a: MaterialLook, b: MaterialLook): boolean =>
  a === b || (a.visible === b.visible && a.opacity === b.opacity && hex_color(a) === hex_color(b));
export const css_color = (look: MaterialLook): string => `rgb(${look.color.join(" ")})`;

// The colour of a set of materials as RGBA bytes, not premultiplied. Hidden materials do not count.
export function color_of_set(set: readonly number[], looks: readonly MaterialLook[]): [number, number, number, number] {
  let [r, g, b, a, n] = [0, 0, 0, 0, 0];
  for (const id of set) {
    const look = looks[id];
    if (!look?.visible) continue;
    r += look.color[0] * look.opacity;
    g += look.color[1] * look.opacity;
    b += look.color[2] * look.opacity;
    a += look.opacity;
    ++n;
  }
  if (a === 0) return [0, 0, 0, 0];
  return [Math.round(r / a), Math.round(g / a), Math.round(b / a), Math.round((255 * a) / n)];
}

// The colour of a set as the page shows it: clear materials count half when the set holds others. On coarse levels a
// sheet one cell thick is mostly air, and it must still be seen.
export function shown_color(set: readonly number[], looks: readonly MaterialLook[]): [number, number, number, number] {
  const [r, g, b, a] = color_of_set(set, looks);
  return [r, g, b, set.length > 1 ? Math.round((510 * a) / (255 + a)) : a];
}
