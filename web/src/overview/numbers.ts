// The numbers at the ends of the rulers: what they say, and where they find room. Pure.
import type { Axis } from "../base/axis";
import { coordinate, significant } from "../base/format";

export interface Point {
  readonly x: number;
  readonly y: number;
}

// In CSS pixels from the upper left corner of the panel.
export interface Rect {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

// Where a number would like to be: outside its edge, shifted from the edge's end towards the edge's middle. So the
// numbers of two edges that meet in a corner keep apart.
export interface Wish {
  readonly size: readonly [number, number];
  readonly end: Point;
  readonly outward: Point; // a unit vector across the edge, away from the box
  readonly beyond: Point; // a unit vector along the edge, away from its middle
}

const GAP = 10; // pixels between an edge and its numbers, enough for a knob
const MARGIN = 3; // pixels between numbers, and to the border of the panel
const SHARE = 0.001; // numbers tell apart this share of their axis, or a cell where that is larger

// The coordinate at an end of an axis, as text.
export function end_text(axis: Axis, x: number): string {
  const extent = axis.max - axis.min;
  const step = Math.min(Math.max(extent / axis.cells, extent * SHARE), 10 * extent * SHARE);
  const text = step < 1e-6 || step > 1e9 ? significant(x, 4) : coordinate(x, 10 * step);
  return text.replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "");
}

export const around = ({ x, y }: Point, [w, h]: readonly [number, number]): Rect => ({
  left: x - w / 2,
  top: y - h / 2,
  right: x + w / 2,
  bottom: y + h / 2,
});
const clamp = (x: number, low: number, high: number) => Math.min(Math.max(x, low), Math.max(low, high));
export const apart = (a: Rect, b: Rect) =>
  a.left >= b.right + MARGIN || b.left >= a.right + MARGIN || a.top >= b.bottom + MARGIN || b.top >= a.bottom + MARGIN;

// The places where a number may be, the best one first: beside its end, beyond it, or one of the two pushed into the
// panel.
function places({ size: [w, h], end, outward, beyond }: Wish, width: number, height: number): Point[] {
  const away = (d: Point, gap: number) => gap + (w * Math.abs(d.x) + h * Math.abs(d.y)) / 2;
  const along = 0.4 * (w * Math.abs(outward.y) + h * Math.abs(outward.x));
  const beside = { x: end.x + outward.x * away(outward, GAP) - beyond.x * along, y: end.y + outward.y * away(outward, GAP) - beyond.y * along };
  const after = { x: end.x + beyond.x * away(beyond, GAP), y: end.y + beyond.y * away(beyond, GAP) };
  const kept = (p: Point) => ({ x: clamp(p.x, w / 2 + MARGIN, width - w / 2 - MARGIN), y: clamp(p.y, h / 2 + MARGIN, height - h / 2 - MARGIN) });
  return [...[beside, after].filter((p) => kept(p).x === p.x && kept(p).y === p.y), kept(beside), kept(after)];
}

// The middle of each number, the most important number first; null where there is no room, or where the end is not in
// sight. All numbers that can have their best place get it before others look for another one.
export function place_numbers(wishes: readonly Wish[], width: number, height: number, taken: readonly Rect[]): (Point | null)[] {
  const used = [...taken];
  const choices = wishes.map((wish) =>
    wish.end.x < 0 || wish.end.y < 0 || wish.end.x > width || wish.end.y > height ? [] : places(wish, width, height),
  );
  const found: (Point | null)[] = wishes.map(() => null);
  for (const most of [1, Infinity])
    wishes.forEach(({ size }, i) => {
      if (found[i]) return;
      const place = choices[i]!.slice(0, most).find((p) => used.every((rect) => apart(rect, around(p, size))));
      if (!place) return;
      found[i] = place;
      used.push(around(place, size));
    });
  return found;
}
