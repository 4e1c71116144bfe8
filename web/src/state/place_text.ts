// Places as text: what people type or paste, and what the read-out copies, which is read back as the same cell.
//
// Three numbers are coordinates in the grid's unit, or in the one behind them. They are a cell where "cell" says so, or i, j and k. Three whole
// numbers without a unit may mean either: then the coordinates come first. With names, such as "z = 5 mm", one number will do, and the others
// stay. Numbers are parted by commas, semicolons or spaces, in brackets or not; a comma is a decimal comma where there are three numbers only
// if it is one.
import type { Axis } from "../base/axis";
import { AXES, type AxisIndex, type Index3, for_axes } from "../base/grid";
import { METRES } from "../base/lengths";
import { outside_cell, outside_place } from "./outside";

type Axes = readonly [Axis, Axis, Axis];

export interface Spot {
  readonly by: "coordinates" | "cell"; // how the text was understood
  readonly point: readonly [number, number, number]; // in the grid's unit; of a cell, its sample point
  readonly cell: Index3; // the nearest one in the grid
  readonly outside: string | null; // what to say if it lies outside
}

interface Part {
  readonly axis: AxisIndex;
  readonly number: number;
  readonly unit: string | null;
}
interface Words {
  readonly cells: boolean;
  readonly parts: readonly Part[];
}

const UNITS = [...Object.keys(METRES), "km"].sort((a, b) => b.length - a.length);
const PART = new RegExp(`(?:([xyzijk])\\s*[=:]?\\s*)?([-+]?(?:\\d+\\.?\\d*|\\.\\d+)(?:e[-+]?\\d+)?)\\s*(?:(${UNITS.join("|")})(?![a-z]))?[\\s,;]*`, "iy");

// The parts of a text, one after another; null when there is anything else in it.
function parts_of(text: string): RegExpExecArray[] | null {
  const found: RegExpExecArray[] = [];
  PART.lastIndex = 0;
  while (PART.lastIndex < text.length) {
    const part = PART.exec(text);
    if (!part) return null;
    found.push(part);
  }
  return found;
}

function words_of(text: string): Words | null {
  const plain = text
    .replace(/−/g, "-")
    .replace(/[µμ]m/g, "um")
    .replace(/(\d)[\u202f\u2009](?=\d)/g, "$1") // between thousands, as this page writes them
    .replace(/[()[\]{}<>]/g, " ")
    .trim();
  const cells = /^(cells?|index|voxel)\b|\bcells?$/i.test(plain);
  const rest = plain.replace(/^(cells?|index|voxel)\b\s*[:=]?|\bcells?$/gi, "").trim();
  const readings = [rest, rest.replace(/(\d),(?=\d)/g, "$1.")].map(parts_of);
  const found = readings.find((parts) => parts?.length === 3) ?? readings[0];
  if (!found || found.length === 0) return null;
  const names = found.map(([, name]) => name?.toLowerCase());
  const named = names.every((name) => name !== undefined);
  if (!named && (found.length !== 3 || names.some((name) => name !== undefined))) return null;
  const as_cells = named && names.every((name) => "ijk".includes(name!));
  if (named && !as_cells && !names.every((name) => "xyz".includes(name!))) return null;
  const axes = named ? names.map((name) => ((as_cells ? "ijk" : "xyz").indexOf(name!)) as AxisIndex) : AXES;
  if (new Set(axes).size < axes.length) return null;
  // A unit also holds for what stands before it without one.
  let unit: string | null = null;
  const units = found.map(([, , , own]) => own?.toLowerCase()).reverse().map((own) => (unit = own ?? unit)).reverse();
  return { cells: cells || as_cells, parts: found.map((part, n) => ({ axis: axes[n]!, number: Number(part[2]), unit: units[n]! })) };
}

// What a text may mean, the likeliest first; none when it is no place. What it does not name is as `here`.
export function spots_of(text: string, axes: Axes, units: string, here: Index3): Spot[] {
  const words = words_of(text);
  if (!words) return [];
  const { parts } = words;
  const of_axis = <T>(d: AxisIndex, take: (part: Part) => T, otherwise: T): T => {
    const part = parts.find(({ axis }) => axis === d);
    return part ? take(part) : otherwise;
  };
  const spots: Spot[] = [];
  const scale = (unit: string | null) => (unit === null || unit === units ? 1 : unit === "km" ? 1e3 / METRES[units]! : METRES[unit]! / METRES[units]!);
  if (!words.cells && parts.every(({ unit }) => Number.isFinite(scale(unit)))) {
    const point = for_axes((d) => of_axis(d, ({ number, unit }) => number * scale(unit), axes[d].centre(here[d])));
    spots.push({ by: "coordinates", point, cell: for_axes((d) => axes[d].clamp(axes[d].cell_at(point[d]))), outside: outside_place(axes, point, units) });
  }
  if (parts.every(({ number, unit }) => unit === null && Number.isInteger(number))) {
    const asked = for_axes((d) => of_axis(d, ({ number }) => number, here[d]));
    const cell = for_axes((d) => axes[d].clamp(asked[d]));
    const outside = outside_cell(axes, asked);
    // Where it was not said, a cell that is not there was not meant.
    if (words.cells || !outside) spots.push({ by: "cell", point: for_axes((d) => axes[d].centre(cell[d])), cell, outside });
  }
  return spots;
}

export const cell_text = (cell: Index3): string => `cell ${cell.join(", ")}`;

// The coordinates of a cell, with as few digits as lead back to it and show a hundredth of its width.
export function coordinates_text(axes: Axes, cell: Index3, units: string): string {
  const text = (d: AxisIndex) => {
    const [axis, i] = [axes[d], cell[d]];
    const x = axis.centre(i);
    for (let digits = 1; digits < 17; ++digits) {
      const short = Number(x.toPrecision(digits));
      if (axis.cell_at(short) === i && Math.abs(short - x) < axis.width(i) / 100) return String(short);
    }
    return String(x);
  };
  return `${AXES.map(text).join(", ")} ${units}`;
}
