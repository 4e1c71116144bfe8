// Which labels are seen in which layer, and how they look. Solid ones share a layer: the nearest hides the others. What is clear has a layer for
// each material, as long as these are few; what is faint has one. Pure.
import type { LabelLook } from "../../base/materials";
import type { BodyMode } from "../../state/viewer";
import { type Palette, STRIPES, type Substance, VEILS } from "./compose";

const MOST_CLEAR = 6; // layers

// What the overview draws: the looks of labels, how it shows them, and which of them would vanish in glass, so that they are solid in it.
export interface Sight {
  readonly looks: readonly LabelLook[];
  readonly mode: BodyMode;
  readonly small: ReadonlySet<number>;
}

// What a label is made of; null: it is not seen.
export function substance_of({ looks, mode, small }: Sight, label: number): Substance | null {
  const look = looks[label]!;
  if (!look.visible || look.opacity === 0) return null;
  if (look.faint) return "faint";
  if (look.glass ?? (mode === "glass" && !small.has(label))) return "glass";
  return look.opacity >= 1 ? "solid" : "clear";
}

// The labels of each layer, ascending; the solid ones come first, the faint ones last.
export function layers_of(sight: Sight): number[][] {
  const [solid, faint]: number[][] = [[], []];
  const clear = new Map<number, number[]>();
  sight.looks.forEach(({ material }, label) => {
    const substance = substance_of(sight, label);
    if (substance === "solid") solid!.push(label);
    else if (substance === "faint") faint!.push(label);
    else if (substance !== null && clear.has(material)) clear.get(material)!.push(label);
    else if (substance !== null) clear.set(material, [label]);
  });
  const groups = [...clear.values()];
  const alone = groups.slice(0, MOST_CLEAR);
  const together = groups.slice(MOST_CLEAR).flat().sort((a, b) => a - b);
  return [solid!, ...alone, together, faint!].filter((labels) => labels.length > 0);
}

export function palette_of(sight: Sight): Palette {
  const { looks } = sight;
  const all = looks.length + STRIPES.length;
  const squares = new Float32Array(3 * all);
  const opacity = new Float32Array(all).fill(1);
  const veil = new Uint8Array(all); // solid
  STRIPES.flat().forEach((c, i) => (squares[3 * looks.length + i] = (c / 255) ** 2));
  looks.forEach((look, label) => {
    look.color.forEach((c, i) => (squares[3 * label + i] = (c / 255) ** 2));
    opacity[label] = look.opacity;
    veil[label] = VEILS.indexOf(substance_of(sight, label) ?? "solid");
  });
  return { squares, opacity, veil, damaged: looks.length };
}
