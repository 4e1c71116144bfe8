// Colours that stay apart for colour-blind eyes: those that the mesher gives materials without one (mesher/scene_names.cpp), after
// M. Okabe, K. Ito: Color Universal Design, 2008, less its black; then darker shades of them.
import type { MaterialLook } from "../materials";

const COLORS: readonly (readonly [number, number, number])[] = [
  [0x56, 0xb4, 0xe9],
  [0xe6, 0x9f, 0x00],
  [0x00, 0x9e, 0x73],
  [0xd5, 0x5e, 0x00],
  [0xcc, 0x79, 0xa7],
  [0xf0, 0xe4, 0x42],
  [0x00, 0x72, 0xb2],
];
const PERCENT = [100, 65, 40];

// Of material 1, 2, ...; the background, 0, has none of its own.
export function distinct_color(id: number): [number, number, number] {
  const color = COLORS[(id - 1) % COLORS.length]!;
  const shade = PERCENT[Math.floor((id - 1) / COLORS.length) % PERCENT.length]!;
  return [0, 1, 2].map((i) => Math.floor((color[i]! * shade) / 100)) as [number, number, number];
}

const is_distinct = (look: MaterialLook, id: number) => id === 0 || distinct_color(id).every((c, i) => c === look.color[i]);

export const all_distinct = (looks: readonly MaterialLook[]): boolean => looks.every(is_distinct);

export const with_distinct_colors = (looks: readonly MaterialLook[]): MaterialLook[] =>
  looks.map((look, id) => (id === 0 ? look : { ...look, color: distinct_color(id) }));

export const with_colors_of = (looks: readonly MaterialLook[], standard: readonly MaterialLook[]): MaterialLook[] =>
  looks.map((look, id) => ({ ...look, color: standard[id]!.color }));
