// Two slices that are compared: of two grids, or of one. Places are compared in coordinates, so the grids may have cells
// of other sizes, and the domains may differ.
import { type Signal, batch, effect } from "@preact/signals";
import type { Axis } from "../base/axis";
import { sizes, unit_name } from "../base/format";
import { AXES, AXIS_NAMES, type AxisIndex, type AxisJson, type Change, type GridInfo, type GridSummary, type Index3, type Material, for_axes } from "../base/grid";
import { METRES } from "../base/lengths";
import type { MaterialLook } from "../base/materials";
import { COMPARISON_MODES, type Comparison, type ComparisonMode, type Viewer } from "./viewer";
import type { Range } from "./zoom";

// How a comparison begins. Two slices of one grid lie apart, or there would be nothing to be seen.
export function new_comparison(viewer: Viewer, other: string, axis: AxisIndex): Comparison {
  const same = other === viewer.info.id;
  const { min, max } = viewer.axes[axis];
  const at = middle_of(viewer.axes[axis], viewer.cell.peek()[axis]);
  const tenth = (max - min) / 10;
  return { other, axis, space: false, mode: "side", wipe: 0.5, together: !same, apart: same ? (at + tenth < max ? tenth : -tenth) : 0 };
}

// z, when it is not the name of an axis: of a layout, the axis across which its slices lie.
export function axis_named(text: string | null): AxisIndex {
  const d = AXIS_NAMES.indexOf(text as "x");
  return d < 0 ? 2 : (d as AxisIndex);
}

// The grids that were compared last, and how. A comparison of one of them begins with the other one.
let last: { readonly grids: readonly [string, string]; readonly mode: ComparisonMode } | null = null;

// Ends the comparison. The overview is as it was before, and so are the slices, unless somebody has moved or zoomed them; where nobody saw that, they
// show everything.
export function end_comparison(viewer: Viewer): void {
  const { before } = viewer;
  const { other, mode } = viewer.compare.value!;
  last = { grids: [viewer.info.id, other], mode };
  batch(() => {
    viewer.compare.value = null;
    viewer.orbit.value = before?.orbit ?? null;
    viewer.bodies.value = before?.bodies ?? "cut";
    if (!viewer.in_frame) return;
    viewer.centre.value = before?.centre ?? viewer.middle();
    viewer.zoom.value = before?.zoom ?? 0;
  });
}

const shows_difference = ({ space, mode }: Comparison): boolean => space && mode === "differs";

// Bodies are cut open at a place that was gone to, which whole ones may hide.
export function show_place(viewer: Viewer, comparison: Comparison): void {
  if (viewer.bodies.value === "whole" && !shows_difference(comparison)) viewer.bodies.value = "cut";
}

// What differs is seen of whole bodies at first: cut open, much of it would be missing.
export function change_comparison(viewer: Viewer, to: Comparison): void {
  const now = viewer.compare.value;
  const did = now !== null && shows_difference(now);
  batch(() => {
    if (shows_difference(to) && !did) viewer.bodies.value = "whole";
    else if (did) show_place(viewer, to);
    viewer.compare.value = to;
  });
}

// Opens or ends the comparison: with the same grid as last time, or else one of as many cells, or another one, or another slice.
export function toggle_comparison(viewer: Viewer, grids: readonly GridSummary[]): void {
  const own = viewer.info.id;
  const others = grids.filter(({ id }) => id !== own);
  const again = last?.grids.includes(own) ? last.grids.find((id) => id !== own) : undefined;
  const other = others.find(({ id }) => id === again) ?? others.find(({ cells }) => cells.every((n, d) => n === viewer.cells[d])) ?? others[0];
  batch(() => {
    viewer.tool.value = "look";
    if (viewer.compare.value) return end_comparison(viewer);
    if (viewer.shows_all()) viewer.zoom.value = 0; // all of both
    viewer.before = { orbit: viewer.orbit.value, bodies: viewer.bodies.value, centre: viewer.centre.value, zoom: viewer.zoom.value };
    if (viewer.in_frame) viewer.zoom.value = 0; // as large as fits there
    const begun = new_comparison(viewer, (other ?? viewer.info).id, axis_named(viewer.layout.peek()));
    change_comparison(viewer, { ...begun, mode: last && again === begun.other ? last.mode : begun.mode, space: viewer.layout.peek() === "3d" && others.length > 0 });
  });
}

// What an address says; null when it says nothing of a comparison. What makes no sense there stays as it would begin.
export function comparison_in(query: URLSearchParams, viewer: Viewer): Comparison | null {
  const other = query.get("compare");
  if (!other) return null;
  const start = new_comparison(viewer, other, axis_named(query.get("across")));
  const mode = query.get("mode") as ComparisonMode | null;
  const number = (key: string, standard: number, good: (x: number) => boolean) => {
    const x = Number(query.get(key) || Number.NaN);
    return Number.isFinite(x) && good(x) ? x : standard;
  };
  const together = query.get("together");
  return {
    ...start,
    space: query.get("space") === "1",
    mode: mode && COMPARISON_MODES.includes(mode) ? mode : start.mode,
    wipe: number("wipe", start.wipe, (x) => x >= 0 && x <= 1),
    together: together === null ? start.together : together === "1",
    apart: number("apart", start.apart, () => true),
  };
}

// REQUIRES: the query has the grid on the left.
export function write_comparison(query: URLSearchParams, { other, axis, space, mode, wipe, together, apart }: Comparison): void {
  query.set("compare", other);
  if (axis !== 2) query.set("across", AXIS_NAMES[axis]);
  if (space) query.set("space", "1");
  if (mode !== "side") query.set("mode", mode);
  if (wipe !== 0.5) query.set("wipe", String(Number(wipe.toFixed(4))));
  const same = other === query.get("g");
  if (together === same) query.set("together", together ? "1" : "0");
  if (same || apart !== 0) query.set("apart", String(apart));
}

// The same grid with its coordinates in another unit, if both are known.
export function in_units(info: GridInfo, units: string): GridInfo {
  const [from, to] = [METRES[info.units], METRES[units]];
  if (info.units === units || !from || !to) return info;
  const by = from / to;
  const scaled = (axis: AxisJson): AxisJson =>
    axis.type === "uniform" ? { ...axis, min: axis.min * by, step: axis.step * by } : { ...axis, planes: axis.planes.map((x) => x * by) };
  const { grid } = info;
  return { ...info, units, to_file: 1 / by, grid: { ...grid, min: grid.min.map((x) => x * by), max: grid.max.map((x) => x * by), axes: grid.axes.map(scaled) } };
}

// Around both.
export const common_bounds = (a: readonly [Range, Range, Range], b: readonly [Range, Range, Range]): [Range, Range, Range] =>
  for_axes((d) => ({ min: Math.min(a[d].min, b[d].min), max: Math.max(a[d].max, b[d].max) }));

// Why the cells of two grids can't be counted against each other, as far as it is seen at once; the server looks at all planes.
export function unequal_cells(a: GridInfo, b: GridInfo): string | null {
  if (a.units !== b.units) return `one is in ${unit_name(a.units)}, the other in ${unit_name(b.units)}`;
  const [n, m] = [a.grid.cells, b.grid.cells];
  return AXES.every((d) => n[d] === m[d]) ? null : `one has ${sizes(n)} cells, the other ${sizes(m)}`;
}

export const exact = (cells: number, text: string | undefined): bigint => BigInt(text ?? cells);

export interface Totals {
  readonly added: bigint;
  readonly removed: bigint;
  readonly differs: bigint;
}

// The cells of all changes by their kind: where the grid on the left has nothing but its background, something was added.
export function totals_of(changes: readonly Change[], left: string, right: string): Totals {
  const totals = { added: 0n, removed: 0n, differs: 0n };
  for (const { from, to, cells, cells_text } of changes) totals[from === left ? "added" : to === right ? "removed" : "differs"] += exact(cells, cells_text);
  return totals;
}

// The looks of the materials on the right: those of the same name on the left, or else their own.
export function looks_by_name(
  left: readonly Material[],
  looks: readonly MaterialLook[],
  right: readonly Material[],
  standard: readonly MaterialLook[],
): MaterialLook[] {
  return right.map(({ name }, id) => looks[left.findIndex((m) => m.name === name)] ?? standard[id]!);
}

// The coordinate in the middle of a cell. Sample points may lie on planes, where rounding could lead to the next cell.
export const middle_of = (axis: Axis, i: number): number => (axis.plane(i) + axis.plane(i + 1)) / 2;

// Whether the slices lie where the comparison says. They don't where one grid ends before the other.
export function slices_meet(left: Viewer, right: Viewer, { axis, apart }: Comparison): boolean {
  const [a, b] = [left.axes[axis], right.axes[axis]];
  const [i, j] = [left.slice[axis].value, right.slice[axis].value];
  return b.cell_at(middle_of(a, i) + apart) === j || a.cell_at(middle_of(b, j) - apart) === i;
}

// Keeps the crosshairs of two viewers at the same place, and their slices together or apart, whichever of them is moved.
// Returns a function that ends this. The cell that follows is not followed back, or a fine grid could not move by less
// than a cell of a coarse one.
export function link(left: Viewer, right: Viewer, comparison: Signal<Comparison | null>): () => void {
  let seen: Comparison | null = null;
  const last = new Map<Viewer, Index3>();

  const follow = (from: Viewer, to: Viewer): void => {
    const c = comparison.peek();
    if (!c) return;
    const moved = from.cell.peek();
    const cell: Index3 = [...to.cell.peek()];
    for (const d of AXES) {
      const apart = d !== c.axis ? 0 : from === left ? c.apart : -c.apart;
      if (d !== c.axis || c.together) cell[d] = to.axes[d].cell_at(middle_of(from.axes[d], moved[d]) + apart);
    }
    to.set_cell(cell);
    last.set(from, moved).set(to, to.cell.peek());
    if (c.together) return;
    const apart = middle_of(right.axes[c.axis], right.cell.peek()[c.axis]) - middle_of(left.axes[c.axis], left.cell.peek()[c.axis]);
    if (apart !== c.apart) comparison.value = seen = { ...c, apart };
  };
  // Puts the slice on the right where the comparison says.
  const place = (c: Comparison): void => {
    const axis = right.axes[c.axis];
    right.set_slice(c.axis, axis.cell_at(middle_of(left.axes[c.axis], left.cell.peek()[c.axis]) + c.apart));
    last.set(right, right.cell.peek());
  };

  const stops = [
    effect(() => {
      const c = comparison.value;
      if (c && (c.axis !== seen?.axis || c.apart !== seen.apart)) place(c);
      seen = c;
    }),
    effect(() => void (left.cell.value !== last.get(left) && follow(left, right))),
    effect(() => void (right.cell.value !== last.get(right) && follow(right, left))),
  ];
  return () => stops.forEach((stop) => stop());
}
