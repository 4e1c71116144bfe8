// Colours that colour-blind people can tell apart. They are those that the mesher gives to materials without a colour:
// the colours of M. Okabe, K. Ito, "Color Universal Design", 2008, without black, and then darker shades of them. Where
// the mesher starts over, further shades follow here.
import type { MaterialLook } from "../base/materials";

const COLORS: readonly (readonly [number, number, number])[] = [
  [0x56, 0xb4, 0xe9],
  [0xe6, 0x9f, 0x00],
  [0x00, 0x9e, 0x73],
  [0xd5, 0x5e, 0x00],
  [0xcc, 0x79, 0xa7],
  [0xf0, 0xe4, 0x42],
  [0x00, 0x72, 0xb2],
];
const SHADES = [[100, 0], [65, 0], [40, 0], [55, 45], [82, 0], [30, 70], [52, 0]] as const; // percent of the colour, and of white

// The colour of material 1, 2, ...; the background, 0, has none.
export function distinct_color(id: number): [number, number, number] {
  const color = COLORS[(id - 1) % COLORS.length]!;
  const [own, white] = SHADES[Math.floor((id - 1) / COLORS.length) % SHADES.length]!;
  return color.map((c) => Math.floor((c * own + 255 * white) / 100)) as [number, number, number];
}

const is_distinct = (look: MaterialLook, id: number) => id === 0 || distinct_color(id).every((c, i) => c === look.color[i]);

export const all_distinct = (looks: readonly MaterialLook[]): boolean => looks.every(is_distinct);

export const with_distinct_colors = (looks: readonly MaterialLook[]): MaterialLook[] =>
  looks.map((look, id) => (id === 0 ? look : { ...look, color: distinct_color(id) }));

export const with_colors_of = (looks: readonly MaterialLook[], standard: readonly MaterialLook[]): MaterialLook[] =>
  looks.map((look, id) => ({ ...look, color: standard[id]!.color }));
