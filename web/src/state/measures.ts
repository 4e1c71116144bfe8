// What was measured: lines with their lengths, in the order in which they were drawn. One of them may be chosen.
import { batch } from "@preact/signals";
import { csv_name } from "../base/format";
import { type AxisIndex, for_axes } from "../base/grid";
import { length_text } from "../base/lengths";
import type { Measure, Viewer } from "./viewer";

type Point = [number, number, number];

export const length_of = ({ from, to }: Pick<Measure, "from" | "to">): number => Math.hypot(...for_axes((d) => to[d] - from[d]));
export const label_of_measure = (m: Measure, units: string): string => `${m.name && `${m.name} · `}${length_text(length_of(m), units, 5)}`;
export const name_of_measure = (m: Measure, n: number): string => m.name || `Line ${n + 1}`;

export const next_id = (measures: readonly Measure[]): number => Math.max(0, ...measures.map(({ id }) => id)) + 1;

// Draws a line, in place of the one with its id if there is one, and chooses it.
export function put_measure(viewer: Viewer, measure: Measure): void {
  const all = viewer.measures.value;
  batch(() => {
    viewer.measures.value = all.some(({ id }) => id === measure.id) ? all.map((m) => (m.id === measure.id ? measure : m)) : [...all, measure];
    viewer.chosen.value = measure.id;
  });
}

// The line that has no end yet.
export const unfinished = ({ measures, measuring, tool }: Viewer): Measure | null =>
  (tool.value === "measure" && measures.value.find(({ id }) => id === measuring.value)) || null;

export function remove_measure(viewer: Viewer, id: number): void {
  batch(() => {
    viewer.measures.value = viewer.measures.value.filter((m) => m.id !== id);
    if (viewer.chosen.value === id) viewer.chosen.value = null;
  });
}

export function measures_csv(measures: readonly Measure[], units: string): string {
  const lines = [`name,length_${units},${["from", "to", "along"].flatMap((what) => ["x", "y", "z"].map((d) => `${what}_${d}`)).join()}`];
  measures.forEach((m, n) => lines.push([csv_name(name_of_measure(m, n)), length_of(m), ...m.from, ...m.to, ...for_axes((d) => m.to[d] - m.from[d])].join()));
  return `${lines.join("\n")}\n`;
}

// In the address: axis,from,to:name, joined by ';'. The axis is 3 for lines in three dimensions.
export const measures_in_address = (measures: readonly Measure[]): string =>
  measures.map(({ axis, from, to, name }) => [axis ?? 3, ...from, ...to].join() + (name && `:${encodeURIComponent(name)}`)).join(";");

// Null for what makes no sense.
export function parsed_measure(text: string, id: number): Measure | null {
  const [place, name] = text.split(":");
  const [axis, ...ends] = place!.split(",").map((n) => (n.trim() ? Number(n) : Number.NaN));
  if (ends.length !== 6 || !ends.every(Number.isFinite) || ![0, 1, 2, 3].includes(axis!)) return null;
  let read = "";
  try {
    read = decodeURIComponent(name ?? "");
  } catch {
    // a name that was cut
  }
  return { id, name: read, axis: axis === 3 ? null : (axis as AxisIndex), from: ends.slice(0, 3) as Point, to: ends.slice(3) as Point };
}
