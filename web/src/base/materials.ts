// How materials look, and bodies where the file keeps them apart: cells carry *labels*, which are materials or bodies. A
// coarse cell holds a set of labels. Its colour is the mean of the colours of its materials, weighted by their opacity, as
// in the pictures that the server makes. Only on the page, air weighs less.
import { type Label, type Material, without_overlap } from "./grid";

export interface MaterialLook {
  color: readonly [number, number, number]; // sRGB, 0 to 255
  visible: boolean;
  opacity: number; // 0 to 1
}

export interface LabelLook extends MaterialLook {
  readonly material: number;
  readonly faint?: boolean; // where something is isolated: whether it only stands around that
  readonly glass?: boolean; // where an overlap is isolated: true of its bodies, which are shown for what lies in them, false of what lies there
}

const FAINT = 0.14; // of the opacity
const strength = ({ opacity, faint }: LabelLook): number => (faint ? FAINT * opacity : opacity);

// The parts of #rrggbb and, if they are there, of #rrggbbaa.
const parts_of_color = (text: string) => [1, 3, 5, 7].map((at) => Number.parseInt(text.slice(at, at + 2) || "ff", 16)) as [number, number, number, number];
export const rgb_of_color = (text: string) => parts_of_color(text).slice(0, 3) as [number, number, number];

export const initial_looks = (materials: readonly Material[]): MaterialLook[] =>
  materials.map(({ color }) => ({ color: rgb_of_color(color), visible: true, opacity: parts_of_color(color)[3] / 255 }));

export const hex_color = (look: Pick<MaterialLook, "color">): string => `#${look.color.map((c) => c.toString(16).padStart(2, "0")).join("")}`;
export const same_look = (a: MaterialLook, b: MaterialLook): boolean =>
  a === b || (a.visible === b.visible && a.opacity === b.opacity && hex_color(a) === hex_color(b));
export const css_color = (look: MaterialLook): string => `rgb(${look.color.join(" ")})`;

// The look of each label. What a body has of its own goes before what its material has, but a hidden material hides its bodies.
export function looks_of_labels(
  labels: readonly Label[],
  of_materials: readonly MaterialLook[],
  of_bodies: ReadonlyMap<number, Partial<MaterialLook>>,
): LabelLook[] {
  return labels.map(({ material }, label) => {
    const look = of_materials[material]!;
    const own = of_bodies.get(without_overlap(labels, label));
    return { ...look, ...own, visible: look.visible && own?.visible !== false, material };
  });
}

// The colour of a set of labels as RGBA bytes, not premultiplied. Hidden labels do not count, and bodies of one material
// count as one.
export function color_of_set(set: readonly number[], looks: readonly LabelLook[]): [number, number, number, number] {
  const materials = new Map<number, LabelLook[]>();
  for (const label of set) {
    const look = looks[label];
    if (!look?.visible) continue;
    const bodies = materials.get(look.material);
    if (bodies) bodies.push(look);
    else materials.set(look.material, [look]);
  }
  let [r, g, b, a] = [0, 0, 0, 0];
  for (const bodies of materials.values())
    for (const look of bodies) {
      const weight = strength(look) / bodies.length;
      r += look.color[0] * weight;
      g += look.color[1] * weight;
      b += look.color[2] * weight;
      a += weight;
    }
  if (a === 0) return [0, 0, 0, 0];
  return [Math.round(r / a), Math.round(g / a), Math.round(b / a), Math.round((255 * a) / materials.size)];
}

// The colour of a set as the page shows it: clear materials count half when the set holds others. On coarse levels a
// sheet one cell thick is mostly air, and it must still be seen.
export function shown_color(set: readonly number[], looks: readonly LabelLook[]): [number, number, number, number] {
  const [r, g, b, a] = color_of_set(set, looks);
  const mixed = set.some((label) => looks[label]?.material !== looks[set[0]!]?.material);
  return [r, g, b, mixed ? Math.round((510 * a) / (255 + a)) : a];
}

// The colour of a mixed cell whose labels are named as often as their shares say. A hidden label is clear here, so that what is left fades.
export function color_of_shares(parts: readonly number[], looks: readonly LabelLook[]): [number, number, number, number] {
  let [r, g, b, a] = [0, 0, 0, 0];
  for (const label of parts) {
    const look = looks[label];
    if (!look?.visible) continue;
    const weight = strength(look);
    r += look.color[0] * weight;
    g += look.color[1] * weight;
    b += look.color[2] * weight;
    a += weight;
  }
  return a === 0 ? [0, 0, 0, 0] : [Math.round(r / a), Math.round(g / a), Math.round(b / a), Math.round((255 * a) / parts.length)];
}
