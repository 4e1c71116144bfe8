// The places of findings, as markers for the views.
import { type Findings, groups_of } from "../base/findings";
import type { Marker } from "./viewer";

const MOST_MARKERS = 24; // more of them hide what they mark

// The worst of each kind, then the next of each.
export function markers_of(findings: Findings): Marker[] {
  const placed = groups_of(findings, "").map((group) => group.findings.filter(({ at }) => at));
  const longest = Math.max(0, ...placed.map((list) => list.length));
  const turns = Array.from({ length: Math.min(longest, MOST_MARKERS) }, (_, i) => placed.flatMap((list) => list.slice(i, i + 1))).flat();
  return turns.slice(0, MOST_MARKERS).map(({ at, text, box, kind }) => ({ at: at!, text, ...(box && { box, guess: kind === "cap" }) }));
}
