// What "Go there" isolates: some bodies, or materials where the file does not keep bodies apart, are drawn in full, and all else stands around
// them as faint as glass. What people have hidden, faded and coloured stays as it is behind that. Pure.
import { type GridInfo, type Label, type Report, without_overlap } from "../base/grid";
import type { LabelLook } from "../base/materials";
import type { Box } from "./boxes";

export interface Isolation {
  readonly labels: readonly number[]; // ascending; none: all is faint, and the box alone says where
  readonly box: Box | null; // where something was found in them, to be outlined
}

// The colour of the cells that several bodies hold, where these are what is looked at. Their bodies are glass around them.
const OVERLAP: LabelLook["color"] = [225, 29, 138];

export const shows_overlap = (labels: readonly Label[], isolation: Isolation): boolean => isolation.labels.some((label) => labels[label]?.overlap);

export function looks_around(looks: readonly LabelLook[], isolation: Isolation | null, labels: readonly Label[]): readonly LabelLook[] {
  if (!isolation) return looks;
  const wanted = new Set(isolation.labels);
  const around = shows_overlap(labels, isolation) ? ({ glass: true } as const) : {};
  return looks.map((look, label) => {
    const full = { ...look, visible: true, opacity: 1, faint: false };
    if (labels[label]?.overlap && wanted.has(label)) return { ...full, color: OVERLAP, glass: false };
    return wanted.has(without_overlap(labels, label)) ? { ...full, ...around } : { ...look, faint: true };
  });
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
    else labels.forEach((label, n) => !label.overlap && materials[label.material]?.name === material && found.add(n));
  }
  return [...found].filter((label) => labels[label]!.material !== 0).sort((a, b) => a - b);
}

// The labels that the cells which two bodies have in common may have, where the file keeps overlaps apart: that of the body that owns them all,
// or else any. A label does not say which bodies its cells lie in, so these cells may be more.
export function labels_of_overlap({ labels, report }: Named, bodies: readonly string[]): number[] {
  const owner = report.overlaps?.list.find((one) => one.bodies.every((name, n) => name === bodies[n]))?.owner;
  return (labels ?? []).flatMap(({ body, overlap }, n) => (overlap && body === (owner ?? body) ? [n] : []));
}

const MOST_NAMES = 3;

// Whether all that a body owns of overlaps is of one pair.
function is_alone(owner: string, overlaps: Report["overlaps"]): boolean {
  const pairs = overlaps?.list.filter((pair) => pair.bodies.includes(owner) && (pair.owner === owner || pair.owner === null));
  return overlaps?.list.length === overlaps?.pairs && pairs?.length === 1;
}

// What is isolated, in words.
export function isolated_text(isolation: Isolation, { labels, overlaps }: { labels: readonly Label[]; overlaps: Report["overlaps"] }, name_of: (label: number) => string, keeps_bodies: boolean): string {
  const own = isolation.labels.filter((label) => !labels[label]?.overlap);
  if (shows_overlap(labels, isolation)) {
    const owners = isolation.labels.flatMap((label) => (labels[label]?.overlap ? [labels[label].body] : []));
    if (owners.length > 1) return "all overlaps";
    return own.length === 2 && is_alone(owners[0]!, overlaps) ? `the overlap of ${own.map(name_of).join(" and ")}` : `the overlaps of ${owners[0]}`;
  }
  if (own.length === 0) return "a place";
  if (own.length > MOST_NAMES) return `${own.length} ${keeps_bodies ? "bodies" : "materials"}`;
  return own.map(name_of).join(", ");
}
