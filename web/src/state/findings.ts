// What `teracell check` has found about a grid, as the server answers it.
import { get_json, list_grids } from "../server/api";
import type { Box, Marker } from "./viewer";

export const LEVELS = ["error", "warning", "note"] as const;
export type Level = (typeof LEVELS)[number];
export type Kind =
  | "empty" | "winding" | "cap" | "seam" | "overlap" | "lost_stretch" | "lost_gap" | "thin" | "island" | "enclosed" | "cut";

export interface Finding {
  kind: Kind;
  level: Level;
  bodies: string[];
  cells: number;
  at: [number, number, number] | null;
  box: Box | null;
  text: string;
}

export interface Wall {
  body: string;
  thinnest_cells: number | null;
  at: [number, number, number] | null;
  histogram: number[]; // cells of thickness 1 to 8, and more
}

export interface Findings {
  findings: Finding[];
  totals: Partial<Record<Kind, { findings: number; cells: number; cells_text?: string }>>;
  walls: Wall[];
  not_looked_at: string[];
}

// Null when nobody has looked through this version of the grid. Throws ServerError.
export async function load_findings(id: string, signal: AbortSignal): Promise<Findings | null> {
  const { grids } = await list_grids(signal);
  if (!grids.find((grid) => grid.id === id)?.checked) return null;
  return get_json<Findings>(`api/v1/grids/${encodeURIComponent(id)}/check`, signal);
}

const MOST_MARKERS = 60;

// The places of findings, the worst first, as markers for the views.
export const markers_of = ({ findings }: Findings): Marker[] =>
  findings.flatMap(({ at, text }) => (at ? [{ at, text }] : [])).slice(0, MOST_MARKERS);

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

export const bodies_of = ({ findings }: Findings): string[] => [...new Set(findings.flatMap((f) => f.bodies))].sort((a, b) => a.localeCompare(b));
