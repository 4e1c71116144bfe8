// The cells of a slice as rectangles of one colour, for pictures made of lines. Pure.
import type { Extent } from "../tiles/place";

export interface Run extends Extent {
  readonly key: string; // of its colour
}

// Joins runs of equal colour and equal ends that lie above each other. Runs come row by row from below; those of one row
// need not be in order. Null when there would be more than `most` rectangles.
export function joined(runs: Iterable<Run>, most: number): Map<string, Extent[]> | null {
  const areas = new Map<string, Extent[]>();
  const open = new Map<string, Extent>(); // the last rectangle with this colour and these ends
  let count = 0;
  for (const { key, u0, u1, v0, v1 } of runs) {
    const place = `${key} ${u0} ${u1}`;
    const below = open.get(place);
    if (below?.v1 === v0) {
      below.v1 = v1;
      continue;
    }
    if (++count > most) return null;
    const area = { u0, u1, v0, v1 };
    open.set(place, area);
    const list = areas.get(key);
    if (list) list.push(area);
    else areas.set(key, [area]);
  }
  return areas;
}
