// Which labels are seen in which layer, and how they look. Opaque ones share a layer: the nearest hides the others. What
// is clear has a layer for each material, as long as these are few. Pure.
import type { LabelLook } from "../base/materials";
import type { BodyMode } from "../state/viewer";
import type { Palette } from "./compose";

const MOST_CLEAR = 6; // layers

// The labels of each layer, ascending; the opaque ones come first.
export function layers_of(looks: readonly LabelLook[], mode: BodyMode): number[][] {
  const opaque: number[] = [];
  const clear = new Map<number, number[]>();
  looks.forEach((look, label) => {
    if (!look.visible || look.opacity === 0) return;
    if (look.opacity >= 1 && mode !== "glass") opaque.push(label);
    else if (clear.has(look.material)) clear.get(look.material)!.push(label);
    else clear.set(look.material, [label]);
  });
  const groups = [...clear.values()];
  const alone = groups.slice(0, MOST_CLEAR);
  const together = groups.slice(MOST_CLEAR).flat().sort((a, b) => a - b);
  return [opaque, ...alone, together].filter((labels) => labels.length > 0);
}

export function palette_of(looks: readonly LabelLook[], mode: BodyMode): Palette {
  const squares = new Float32Array(3 * looks.length);
  const opacity = new Float32Array(looks.length);
  looks.forEach((look, label) => {
    look.color.forEach((c, i) => (squares[3 * label + i] = (c / 255) ** 2));
    opacity[label] = look.opacity;
  });
  return { squares, opacity, glass: mode === "glass" };
}
