// How bodies look, where the file keeps them apart: only what differs from their materials is kept.
import { batch } from "@preact/signals";
import type { MaterialLook } from "../base/materials";
import type { Viewer } from "./viewer";

type BodyLooks = ReadonlyMap<number, Partial<MaterialLook>>;

// With a change to some labels. What is as the material has it is dropped.
export function with_change(looks: BodyLooks, labels: Iterable<number>, change: (label: number) => Partial<MaterialLook>): BodyLooks {
  const next = new Map(looks);
  for (const label of labels) {
    const { visible, ...others } = { ...next.get(label), ...change(label) };
    const own = visible === false ? { ...others, visible } : others;
    if (Object.keys(own).length > 0) next.set(label, own);
    else next.delete(label);
  }
  return next;
}

export function change_bodies(viewer: Viewer, labels: Iterable<number>, what: Partial<MaterialLook>): void {
  const shown = [...labels];
  batch(() => {
    if (what.visible !== undefined) viewer.isolated.value = null; // who chooses what is seen wants to see that
    viewer.body_looks.value = with_change(viewer.body_looks.value, shown, () => what);
    if (what.visible) show_materials_of(viewer, shown);
  });
}

// A body is seen only if its material is.
function show_materials_of(viewer: Viewer, labels: readonly number[]): void {
  const wanted = new Set(labels.map((label) => viewer.labels[label]!.material));
  if (viewer.looks.value.some((look, id) => wanted.has(id) && !look.visible))
    viewer.looks.value = viewer.looks.value.map((look, id) => (wanted.has(id) ? { ...look, visible: true } : look));
}

// Shows these bodies and nothing else.
export function show_only(viewer: Viewer, labels: Iterable<number>): void {
  const wanted = new Set(labels);
  const others = viewer.wholes.filter((label) => !wanted.has(label));
  batch(() => {
    change_bodies(viewer, wanted, { visible: true });
    change_bodies(viewer, others, { visible: false });
  });
}

export function show_all_bodies(viewer: Viewer): void {
  change_bodies(viewer, viewer.wholes, { visible: true });
}
