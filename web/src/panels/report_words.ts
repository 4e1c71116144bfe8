// What meshing found, in words.
import { about, bytes_text, grouped, plural, product, significant, unit_name } from "../base/format";
import type { BodyReport, GridInfo, Hole } from "../base/grid";
import { hole_text } from "../state/places";

export interface Care {
  level: "fine" | "look" | "bad";
  text: string;
}

const HARMLESS = 2; // cells: a narrower hole does no harm, as in the warnings of the mesher

const quoted = (bodies: readonly BodyReport[]) => {
  const names = bodies.slice(0, 3).map((b) => `“${b.name}”`);
  const more = bodies.length - names.length;
  return more > 0
    ? `${names.join(", ")} and ${grouped(more)} more`
    : names.length > 1
      ? `${names.slice(0, -1).join(", ")} and ${names.at(-1)}`
      : names.join("");
};

export const widest = (holes: readonly Hole[]): Hole | undefined =>
  holes.reduce<Hole | undefined>((w, h) => (w && w.diameter >= h.diameter ? w : h), undefined);

// "3 seams, 12 m in all, stitched over gaps of up to 1e-7 m"
export function seams_text(body: BodyReport, units: string): string {
  const { seams } = body;
  if (!seams?.number) return "";
  return `${plural(seams.number, "seam")}, ${significant(seams.length, 4)} ${units} in all, stitched over gaps of up to ${significant(seams.widest_gap, 3)} ${units}`;
}

// Whether to care: a sentence about the worst that was found.
export function care_of(info: GridInfo): Care {
  const { bodies } = info.report;
  const empty = bodies.filter((b) => b.cells === 0);
  const open = bodies.filter((b) => b.holes.some((h) => !h.extruded));
  const holes = open.flatMap((b) => b.holes).filter((h) => !h.extruded);
  const large = holes.filter((h) => (h.diameter_cells ?? Infinity) >= HARMLESS);
  const flipped = bodies.filter((b) => b.flips.length > 0);
  if (empty.length) {
    const owns = empty.length === 1 ? "owns no cell. Is it" : "own no cell. Are they";
    return { level: "bad", text: `Look here: ${quoted(empty)} ${owns} in the right place, and wider than a cell?` };
  }
  if (large.length) {
    const is = open.length === 1 ? "is" : "are";
    const hole = hole_text(widest(large)!, unit_name(info.units));
    const worst = large.length === 1 ? `It has a hole ${hole}. A cap closes it` : `The widest hole is ${hole}. Caps close all of them`;
    return { level: "bad", text: `Look here: ${quoted(open)} ${is} open. ${worst}, and a cap is a guess.` };
  }
  if (holes.length === 1) return { level: "look", text: `Harmless: ${quoted(open)} had a hole narrower than ${HARMLESS} cells, which a cap closes.` };
  if (holes.length)
    return {
      level: "look",
      text: `Harmless: ${quoted(open)} had ${plural(holes.length, "hole")} narrower than ${HARMLESS} cells, which caps close.`,
    };
  if (flipped.length)
    return {
      level: "look",
      text: `Probably fine: ${quoted(flipped)} ${flipped.length === 1 ? "has" : "have"} facets that face the wrong way, so the inside was decided by parity.`,
    };
  if (info.report.warnings.length)
    return { level: "look", text: `All surfaces are closed, but read the ${plural(info.report.warnings.length, "warning")} below.` };
  if (bodies.length === 0) return { level: "fine", text: "There is no body in this grid." };
  const closed =
    bodies.length === 1 ? `the surface of ${quoted(bodies)} is closed` : `all ${grouped(bodies.length)} bodies are closed and have cells`;
  return { level: "fine", text: `Nothing to worry about: ${closed}.` };
}

// The size with one byte per cell, and how many times as large as the file that is.
export function compression(info: GridInfo): { dense: number; times: number } {
  const dense = Number(product(info.grid.cells));
  return { dense, times: dense / info.file.bytes };
}

export function size_text(info: GridInfo): string {
  const { dense, times } = compression(info);
  if (times < 1) return `${bytes_text(dense)}, less than this file`;
  return `${bytes_text(dense)}, ${times >= 1000 ? about(Math.round(times)) : significant(times, 3)} times as much`;
}

export function levels_text(levels: number): string {
  return levels === 1 ? "only the cells themselves" : `${grouped(levels)}, with cells up to ${grouped(2 ** (levels - 1))} times as wide`;
}

export const body_cells = (body: BodyReport): string => plural(body.cells_text ?? body.cells, "cell");
