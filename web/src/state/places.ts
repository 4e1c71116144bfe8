// The places that the report names, as markers for the views and the address.
import { plural, significant, unit_name } from "../base/format";
import type { GridInfo, Hole } from "../base/grid";
import type { Marker } from "./viewer";

const MOST_MARKERS = 500;

// "0.047 m wide, 90.5 cells". For a crack, its gap as well.
export function hole_text(hole: Hole, units: string): string {
  const cells = hole.diameter_cells;
  const crack = hole.width !== undefined && hole.width_cells !== undefined && hole.width < hole.diameter / 4;
  const gap = crack ? `, with a gap of ${significant(hole.width!, 3)} ${units}, ${significant(hole.width_cells!, 3)} cells` : "";
  return `${significant(hole.diameter, 4)} ${units} wide${cells === undefined ? "" : `, ${significant(cells, 3)} cells`}${gap}`;
}

// The places that can be marked in the views, the widest holes first.
export function places_found(info: GridInfo): Marker[] {
  const { bodies } = info.report;
  const holes = bodies.flatMap((b) =>
    b.holes.map((h) => ({ at: h.at, size: h.diameter, text: `hole in ${b.name}: ${hole_text(h, unit_name(info.units))}` })),
  );
  holes.sort((a, b) => b.size - a.size);
  const flips = bodies.flatMap((b) =>
    b.flips.map((f) => ({ at: f.at, text: `${b.name}: facets face opposite ways along ${plural(f.edges, "edge")}` })),
  );
  return [...holes.map(({ at, text }) => ({ at, text })), ...flips].slice(0, MOST_MARKERS);
}
