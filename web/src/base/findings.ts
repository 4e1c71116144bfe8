// What `teracell check` has found about a grid, as the server answers it. Pure.
import { plural } from "./format";
import type { Report } from "./grid";

export const LEVELS = ["error", "warning", "note"] as const;
export type Level = (typeof LEVELS)[number];
export type Kind =
  | "empty" | "winding" | "cap" | "seam" | "overlap" | "lost_stretch" | "lost_gap" | "thin" | "narrow" | "island" | "enclosed" | "cut";

export interface Finding {
  kind: Kind;
  level: Level;
  bodies: string[];
  cells: number;
  at: [number, number, number] | null;
  box: [number, number, number, number, number, number] | null; // cells, half open
  text: string;
}

export interface Wall {
  body: string;
  thinnest_cells: number | null;
  at: [number, number, number] | null;
  histogram: number[]; // cells of thickness 1, 2, .. 7 (by the whole part), and 8 or more
}

export interface Findings {
  findings: Finding[];
  totals: Partial<Record<Kind, { findings: number; cells: number; cells_text?: string }>>;
  walls: Wall[];
  not_looked_at: string[];
}

export interface Group {
  kind: Kind;
  level: Level; // the worst
  findings: Finding[];
  total: number; // also those that are not listed
}

// By kind, the worst first; of one body, where it is named.
export function groups_of({ findings, totals }: Findings, body: string): Group[] {
  const groups = new Map<Kind, Group>();
  for (const finding of findings) {
    if (body && !finding.bodies.includes(body)) continue;
    const group = groups.get(finding.kind);
    if (group) group.findings.push(finding);
    else groups.set(finding.kind, { kind: finding.kind, level: finding.level, findings: [finding], total: 0 });
  }
  for (const group of groups.values()) {
    group.total = body ? group.findings.length : (totals[group.kind]?.findings ?? group.findings.length);
    for (const { level } of group.findings) if (LEVELS.indexOf(level) < LEVELS.indexOf(group.level)) group.level = level;
  }
  return [...groups.values()].sort((a, b) => LEVELS.indexOf(a.level) - LEVELS.indexOf(b.level));
}

// What the mesher has found of overlaps, in the words of `teracell check`.
export function overlaps_reported({ overlaps }: Report): Group | null {
  if (!overlaps?.pairs) return null;
  const findings = overlaps.list.map(({ bodies, cells, cells_text, owner, at, box }): Finding => {
    const text = `'${bodies[0]}' and '${bodies[1]}' overlap in ${plural(cells_text ?? cells, "cell")}, which ${owner === null ? "a third body owns in part" : `'${owner}' owns`}.`;
    return { kind: "overlap", level: "note", bodies, cells, at, box, text };
  });
  return { kind: "overlap", level: "note", findings, total: overlaps.pairs };
}

export const bodies_of = ({ findings }: Findings): string[] => [...new Set(findings.flatMap((f) => f.bodies))].sort((a, b) => a.localeCompare(b));
