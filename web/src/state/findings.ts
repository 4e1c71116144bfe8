// The places of findings, as markers for the views.
import { type Finding, type Findings, type Kind, groups_of } from "../base/findings";
import type { Marker } from "./viewer";

const MOST_MARKERS = 24; // more of them hide what they mark

// What of the findings is looked at: those of a body, of a kind; and one of them.
export interface Focus {
  readonly body: string;
  readonly kind: Kind | null;
  readonly finding: Finding | null;
}
export const ALL: Focus = { body: "", kind: null, finding: null };

const NAMES: Record<Kind, string> = {
  empty: "no cells", winding: "opposite facets", cap: "hole", seam: "seam", overlap: "overlap", lost_stretch: "lost part", lost_gap: "lost gap",
  thin: "thin wall", narrow: "narrow gap", island: "island", enclosed: "enclosed", cut: "cut",
};

// The one that is looked at, then the worst of each kind, then the next of each.
export function markers_of(findings: Findings, { body, kind, finding }: Focus = ALL): Marker[] {
  const groups = groups_of(findings, body).filter((group) => kind === null || group.kind === kind);
  const placed = groups.map((group) => group.findings.filter((f) => f.at && f !== finding));
  const longest = Math.max(0, ...placed.map((list) => list.length));
  const turns = Array.from({ length: Math.min(longest, MOST_MARKERS) }, (_, i) => placed.flatMap((list) => list.slice(i, i + 1))).flat();
  return [...(finding?.at ? [finding] : []), ...turns].slice(0, MOST_MARKERS).map(({ at, text, box, kind: of, bodies }) => ({
    at: at!,
    text,
    name: [NAMES[of], ...bodies].join(" · "),
    ...(box && { box, guess: of === "cap" }),
  }));
}
