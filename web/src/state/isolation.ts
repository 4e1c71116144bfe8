// What "Go there" isolates: some bodies, or materials where the file does not keep bodies apart, are drawn in full, and all else stands around
// them as faint as glass. What people have hidden, faded and coloured stays as it is behind that. Pure.
import type { GridInfo, Label } from "../base/grid";
import type { LabelLook } from "../base/materials";
import type { Box } from "./boxes";

export interface Isolation {
  readonly labels: readonly number[]; // ascending; none: all is faint, and the box alone says where
  readonly box: Box | null; // where something was found in them, to be outlined
}

export function looks_around(looks: readonly LabelLook[], isolation: Isolation | null): readonly LabelLook[] {
  if (!isolation) return looks;
  const wanted = new Set(isolation.labels);
  return looks.map((look, label) => (wanted.has(label) ? { ...look, visible: true, opacity: 1, faint: false } : { ...look, faint: true }));
}

// Of what is marked, what was gone to: the boxes and names of the rest would hide it.
export function marks_in<T extends { box?: Box }>(markers: readonly T[], isolation: Isolation | null): readonly T[] {
  const found = isolation?.box;
  return found ? markers.filter(({ box }) => box?.every((end, n) => end === found[n])) : markers;
}

type Named = Pick<GridInfo, "materials" | "labels" | "report">;

// The labels that names of bodies or materials stand for, without the background; a body that has no label of its own has that of its material.
export function labels_named(info: Named, names: readonly string[]): number[] {
  const { materials } = info;
  const labels: readonly Label[] = info.labels ?? materials.map(({ id }) => ({ material: id, body: "" }));
  const found = new Set<number>();
  for (const name of names) {
    const own = labels.findIndex(({ body }) => body === name);
    const material = info.report.scene?.bodies.find((body) => body.name === name)?.material ?? name;
    if (own >= 0) found.add(own);
    else labels.forEach((label, n) => materials[label.material]?.name === material && found.add(n));
  }
  return [...found].filter((label) => labels[label]!.material !== 0).sort((a, b) => a - b);
}

const MOST_NAMES = 3;

// What is isolated, in words.
export function isolated_text(labels: readonly number[], name_of: (label: number) => string, keeps_bodies: boolean): string {
  if (labels.length === 0) return "a place";
  if (labels.length > MOST_NAMES) return `${labels.length} ${keeps_bodies ? "bodies" : "materials"}`;
  return labels.map(name_of).join(", ");
}
