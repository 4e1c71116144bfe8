// Which labels are seen in which layer, and how they look. Opaque ones share a layer: the nearest hides the others. What
// is clear has a layer for each material, as long as these are few. Pure.
import type { MaterialLook } from "../base/materials";
import type { BodyMode } from "../state/viewer";
import type { Palette } from "./compose";

const MOST_CLEAR = 6; // layers

// `material_of`: of each label. The labels of each layer, ascending; the opaque ones come first.
export function layers_of(material_of: readonly number[], looks: readonly MaterialLook[], mode: BodyMode, hidden: ReadonlySet<number> = new Set()): number[][] {
  const opaque: number[] = [];
  const clear = new Map<number, number[]>();
  material_of.forEach((material, label) => {
    const look = looks[material];
    if (!look?.visible || look.opacity === 0 || hidden.has(label)) return;
    if (look.opacity >= 1 && mode !== "glass") opaque.push(label);
    else clear.set(material, [...(clear.get(material) ?? []), label]);
  });
  const groups = [...clear.values()];
  const alone = groups.slice(0, MOST_CLEAR);
  const together = groups.slice(MOST_CLEAR).flat().sort((a, b) => a - b);
  return [opaque, ...alone, together].filter((labels) => labels.length > 0);
}

export function palette_of(material_of: readonly number[], looks: readonly MaterialLook[], mode: BodyMode): Palette {
  const squares = new Float32Array(3 * material_of.length);
  const opacity = new Float32Array(material_of.length);
  material_of.forEach((material, label) => {
    const look = looks[material];
    if (!look) return;
    look.color.forEach((c, i) => (squares[3 * label + i] = (c / 255) ** 2));
    opacity[label] = look.opacity;
  });
  return { squares, opacity, glass: mode === "glass" };
}

// As the server is asked for them: 1-4,7.
export function ranges(labels: readonly number[]): string {
  const out: string[] = [];
  for (let i = 0; i < labels.length; ) {
    let end = i;
    while (end + 1 < labels.length && labels[end + 1] === labels[end]! + 1) ++end;
    out.push(end > i ? `${labels[i]}-${labels[end]}` : `${labels[i]}`);
    i = end + 1;
  }
  return out.join(",");
}
