// What meshing found, in words.
import { about, bytes_text, grouped, noun, plural, product, significant, unit_name, upper_first } from "../base/format";
import type { BodyReport, GridInfo, Hole } from "../base/grid";
import { hole_text } from "../state/places";

export interface Care {
  level: "fine" | "look" | "bad";
  text: string;
}

export const DAMAGED: Care = { level: "bad", text: "The file is damaged: parts of it can't be read." };

const HARMLESS = 2; // cells: a narrower hole does no harm, as in the warnings of the mesher

const quoted = (bodies: readonly BodyReport[]) => {
  const names = bodies.slice(0, 3).map((b) => `“${b.name}”`);
  const more = bodies.length - names.length;
  const last = more > 0 ? `${grouped(more)} more` : names.pop()!;
  return names.length ? `${names.join(", ")} and ${last}` : last;
};

export const widest = (holes: readonly Hole[]): Hole | undefined =>
  holes.reduce<Hole | undefined>((w, h) => (w && w.diameter >= h.diameter ? w : h), undefined);

// "3 seams, 12 m in all, stitched over gaps of up to 1e-7 m"
export function seams_text(body: BodyReport, units: string): string {
  const { seams } = body;
  if (!seams?.number) return "";
  const [length, gap] = [significant(seams.length, 4), significant(seams.widest_gap, 3)];
  return `${plural(seams.number, "seam")}, ${length} ${units} in all, stitched over gaps of up to ${gap} ${units}`;
}

// Whether anything needs attention: a sentence about the worst that was found, which is as bad as `teracell check` says.
export function care_of(info: GridInfo): Care {
  const { bodies } = info.report;
  const empty = bodies.filter((b) => b.cells === 0);
  const open = bodies.filter((b) => b.holes.some((h) => !h.extruded));
  const holes = open.flatMap((b) => b.holes).filter((h) => !h.extruded);
  const large = holes.filter((h) => (h.diameter_cells ?? Infinity) >= HARMLESS);
  const opposite = bodies.filter((b) => b.flips.length > 0);
  if (empty.length) {
    if (empty.every((b) => b.covered_cells))
      return { level: "bad", text: `Look here: ${quoted(empty)} ${noun(empty.length, "owns", "own")} no cell, because stronger bodies own all that ${noun(empty.length, "it holds", "they hold")}.` };
    const owns = empty.length === 1 ? "owns no cell. Is it" : "own no cell. Are they";
    return { level: "bad", text: `Look here: ${quoted(empty)} ${owns} in the right place, and wider than a cell?` };
  }
  if (large.length) {
    const hole = hole_text(widest(large)!, unit_name(info.units));
    const worst = large.length === 1 ? `It has a hole ${hole}. A cap closes it` : `The widest hole is ${hole}. Caps close all of them`;
    return { level: "look", text: `Look here: ${quoted(open)} ${noun(open.length, "is", "are")} open. ${worst}, and a cap is a guess.` };
  }
  const have = (list: readonly BodyReport[]) => `${quoted(list)} ${noun(list.length, "has", "have")}`;
  if (holes.length) {
    const [found, close] = holes.length === 1 ? ["a hole", "a cap closes"] : [plural(holes.length, "hole"), "caps close"];
    return { level: "look", text: `${have(open)} ${found} narrower than ${HARMLESS} cells, which ${close}.` };
  }
  if (opposite.length) {
    const text = `${have(opposite)} facets that face the opposite way from their neighbours, so parity decides the inside.`;
    return { level: "look", text };
  }
  if (info.report.warnings.length)
    return { level: "look", text: `All surfaces are closed, but read the ${plural(info.report.warnings.length, "warning")} below.` };
  if (bodies.length === 0) return { level: "fine", text: "There is no body in this grid." };
  const closed =
    bodies.length === 1 ? `the surface of ${quoted(bodies)} is closed` : `all ${grouped(bodies.length)} bodies are closed and have cells`;
  return { level: "fine", text: `${upper_first(closed)}.` };
}

// The size with one byte per cell, and how many times the size of the file that is.
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
