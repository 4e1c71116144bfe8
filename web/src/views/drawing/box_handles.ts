// The handles of the box in a slice: at its corners and the middles of its sides they move these, in its middle all of it. Pure.
import type { Axis, Frame } from "../../base/axis";
import type { Box } from "../../state/viewer";
import type { Extent } from "../../tiles/place";
import type { Camera } from "./camera";

// Which side of the box a handle moves along u and v: -1 the lower one, 1 the upper one, 0 none; both 0: the whole box.
export interface Handle {
  readonly u: -1 | 0 | 1;
  readonly v: -1 | 0 | 1;
}

export const HANDLE = 4; // CSS pixels, half the side of a handle
const HIT = 9; // CSS pixels around its middle
const APART = 28; // CSS pixels: a box smaller than this has handles at its corners alone

const ALL: readonly Handle[] = ([-1, 0, 1] as const).flatMap((v) => ([-1, 0, 1] as const).map((u) => ({ u, v })));

export interface PlacedHandle extends Handle {
  readonly x: number; // CSS pixels of the view
  readonly y: number;
}

export const extent_in = (frame: Frame, box: Box): Extent => ({ u0: box[frame.u], u1: box[frame.u + 3]!, v0: box[frame.v], v1: box[frame.v + 3]! });

export function handles_of(camera: Pick<Camera, "place_of">, frame: Frame, box: Box): PlacedHandle[] {
  const place = (low: number, high: number, at: -1 | 0 | 1) => (at === 0 ? (low + high) / 2 : at < 0 ? low : high);
  const { left, right, top, bottom } = camera.place_of(extent_in(frame, box));
  const shown = (handle: Handle) => (handle.u !== 0 || right - left >= APART) && (handle.v !== 0 || bottom - top >= APART);
  return ALL.filter(shown).map((handle) => ({ ...handle, x: place(left, right, handle.u), y: place(bottom, top, handle.v) }));
}

export const handle_at = (handles: readonly PlacedHandle[], x: number, y: number): Handle | null =>
  handles.find((handle) => Math.max(Math.abs(handle.x - x), Math.abs(handle.y - y)) <= HIT) ?? null;

// The plane between cells that lies nearest to a coordinate.
export function nearest_plane(axis: Axis, x: number): number {
  const i = Math.min(Math.max(axis.cell_at(x), 0), axis.cells - 1);
  return x - axis.plane(i) < axis.plane(i + 1) - x ? i : i + 1;
}

// How many cells of an axis lie between two coordinates, those at its ends included; 0 where there is no length between them.
export function cells_between(axis: Axis, a: number, b: number): number {
  const [low, high] = [axis.inside(Math.min(a, b)), axis.inside(Math.max(a, b))];
  if (high <= low) return 0;
  const last = Math.min(axis.cell_at(high), axis.cells - 1);
  return last - axis.cell_at(low) + (axis.plane(last) < high ? 1 : 0);
}

// One side moved to a plane: at least one cell is left.
function with_side(box: Box, d: number, side: -1 | 1, plane: number): Box {
  const out: Box = [...box];
  if (side < 0) out[d] = Math.min(plane, box[d + 3]! - 1);
  else out[d + 3] = Math.max(plane, box[d]! + 1);
  return out;
}

// The box after its handle was dragged from one point of the slice to another, given as coordinates.
export function dragged(axes: readonly [Axis, Axis, Axis], frame: Frame, box: Box, handle: Handle, from: readonly [number, number], to: readonly [number, number]): Box {
  let out = box;
  ([frame.u, frame.v] as const).forEach((d, i) => {
    const side = i === 0 ? handle.u : handle.v;
    if (side !== 0) out = with_side(out, d, side, nearest_plane(axes[d], to[i]!));
    else if (handle.u === 0 && handle.v === 0) {
      const size = box[d + 3]! - box[d];
      const low = nearest_plane(axes[d], axes[d].plane(box[d]) + to[i]! - from[i]!);
      out = [...out];
      out[d] = Math.min(Math.max(low, 0), axes[d].cells - size);
      out[d + 3] = out[d] + size;
    }
  });
  return out;
}

const CURSORS = { "-1 -1": "nesw-resize", "1 1": "nesw-resize", "-1 1": "nwse-resize", "1 -1": "nwse-resize", "0 0": "move" } as Record<string, string>;
export const cursor_of = ({ u, v }: Handle): string => CURSORS[`${u} ${v}`] ?? (u === 0 ? "ns-resize" : "ew-resize");
