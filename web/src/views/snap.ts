// Ends of measured lines snap to boundaries between materials: exact ones, from the runs of the cells' row and column through the
// pointer, at whatever zoom.
import { FRAMES } from "../base/axis";
import type { AxisIndex, Column, ColumnRun } from "../base/grid";
import { get_json } from "../server/api";
import type { Viewer } from "../state/viewer";

const REACH = 8; // CSS pixels
const MOST_CELLS = 1 << 20; // that are looked through

// The boundary between two runs that lies nearest to a coordinate, and within reach of it; null when there is none.
export function nearest_boundary(runs: readonly Pick<ColumnRun, "min" | "max">[], x: number, reach: number): number | null {
  let best: number | null = null;
  for (const { min } of runs.slice(1)) if (Math.abs(min - x) <= reach && (best === null || Math.abs(min - x) < Math.abs(best - x))) best = min;
  return best;
}

// The point to which a point of a slice snaps; the point itself when no boundary is near.
export async function snapped(viewer: Viewer, axis: AxisIndex, point: readonly [number, number, number], signal: AbortSignal): Promise<[number, number, number]> {
  const { u, v } = FRAMES[axis];
  const reach = REACH / viewer.zoom.peek();
  const along = async (d: AxisIndex): Promise<number | null> => {
    const own = viewer.axes[d];
    const [low, high] = [own.clamp(own.cell_at(point[d] - reach)), own.clamp(own.cell_at(point[d] + reach))];
    if (high - low > MOST_CELLS) return null;
    const cell = ([0, 1, 2] as const).map((e) => viewer.axes[e].clamp(viewer.axes[e].cell_at(point[e])));
    const frame = FRAMES[d];
    const address = viewer.address.column(d, cell[frame.u]!, cell[frame.v]!, Math.max(low - 1, 0), Math.min(high + 2, own.cells));
    // Planes are those of the axis: of a grid that is shown in another unit, the answer has the file's own.
    const planes = (await get_json<Column>(address, signal)).runs.map(({ from, to }) => ({ min: own.plane(from), max: own.plane(to) }));
    return nearest_boundary(planes, point[d], reach);
  };
  const [a, b] = await Promise.all([along(u), along(v)]);
  return nearer(point, u, a, v, b);
}

// The point with one coordinate moved: both together would leave an aslant boundary again.
export function nearer(point: readonly [number, number, number], u: AxisIndex, a: number | null, v: AxisIndex, b: number | null): [number, number, number] {
  const out: [number, number, number] = [...point];
  if (a !== null && (b === null || Math.abs(a - point[u]) <= Math.abs(b - point[v]))) out[u] = a;
  else if (b !== null) out[v] = b;
  return out;
}
