// The boxes of what fills a grid: around several, how large, and which are small. Pure.
import type { Axis } from "../base/axis";
import { AXES, type Amount, type BodyStats, for_axes } from "../base/grid";
import type { Range } from "./zoom";

export type Box = [number, number, number, number, number, number]; // cells of level 0, half open: x0, y0, z0, x1, y1, z1

type Axes = readonly [Axis, Axis, Axis];

// Where a box of cells lies, in coordinates.
export const ranges_of = (axes: Axes, box: Box): [Range, Range, Range] =>
  for_axes((d) => ({ min: axes[d].plane(box[d]), max: axes[d].plane(box[d + 3]!) }));

export function box_around(boxes: readonly (Box | null | undefined)[]): Box | null {
  return boxes.reduce<Box | null>((all, box) => {
    if (!all || !box) return all ?? box ?? null;
    return [0, 1, 2, 3, 4, 5].map((end) => (end < 3 ? Math.min : Math.max)(all[end]!, box[end]!)) as Box;
  }, null);
}

// Where the cells that lie in other bodies as well have an amount of their own, each body's becomes that of both.
export function with_overlaps<T extends BodyStats>(amounts: readonly T[]): readonly T[] {
  return amounts.map((amount, label) => {
    const more = amounts[label + 1];
    if (!more?.overlap || more.cells === 0) return amount;
    const { cells_text: _, ...rest } = amount;
    const exact = BigInt(amount.cells_text ?? amount.cells) + BigInt(more.cells_text ?? more.cells);
    const large = exact > BigInt(Number.MAX_SAFE_INTEGER) ? { cells_text: String(exact) } : {};
    return { ...rest, ...large, cells: Number(exact), volume: amount.volume + more.volume, box: box_around([amount.box, more.box]) } as T;
  });
}

const longest_side = (axes: Axes, box: Box): number => Math.max(...ranges_of(axes, box).map(({ min, max }) => max - min));

// With as much room on all sides as is a share of its longest side, and these cells, as far as the domain reaches.
export function with_room(axes: Axes, box: Box, share: number, cells = 0): [Range, Range, Range] {
  const room = share * longest_side(axes, box) + cells * Math.max(...AXES.map((d) => axes[d].width((box[d] + box[d + 3]!) >> 1)));
  const ranges = ranges_of(axes, box);
  return for_axes((d) => ({ min: axes[d].inside(ranges[d].min - room), max: axes[d].inside(ranges[d].max + room) }));
}

const SMALL = 1 / 8; // of the longest side of the largest

// Labels whose boxes are small beside the largest of them, the background's aside. Beside that, not beside the domain: of an assembly in wide air
// all is small.
export function small_labels(axes: Axes, amounts: readonly Amount[], is_background: (label: number) => boolean): ReadonlySet<number> {
  const sides = amounts.map(({ box }, label) => (box && !is_background(label) ? longest_side(axes, box) : 0));
  const largest = Math.max(0, ...sides);
  return new Set(sides.flatMap((side, label) => (side > 0 && side <= SMALL * largest ? [label] : [])));
}
