// Findings in words: what each kind is called, and whether there is reason to worry.
import { type Findings, type Kind, LEVELS, type Level } from "../base/findings";
import { grouped, plural } from "../base/format";
import type { Care } from "./report_words";

export const KINDS: Record<Kind, { name: string; means: string }> = {
  empty: { name: "Bodies without cells", means: "They lie outside the domain or between sample points, or stronger bodies own all of their cells." },
  winding: { name: "Facets that face opposite ways", means: "Which side is inside was decided by parity there." },
  cap: { name: "Holes", means: "They were closed by caps. A cap is a guess." },
  seam: { name: "Seams", means: "Open edges close to each other were stitched." },
  overlap: { name: "Overlaps", means: "Cells that lie in two bodies belong to the stronger one." },
  lost_stretch: { name: "Lost parts", means: "They are thinner than a cell: no sample point meets them. Bodies with \"thin\": \"keep\" have cells there all the same." },
  lost_gap: { name: "Lost gaps", means: "They are narrower than a cell, so what they part has grown together." },
  thin: { name: "Thin walls", means: "So few cells thick that finer ones would resolve them better." },
  narrow: { name: "Narrow gaps", means: "So few cells of background wide that finer ones would resolve them better." },
  island: { name: "Islands", means: "Cells that hang together with the rest of their body through no face." },
  enclosed: { name: "Enclosed background", means: "No way through faces leads from it to a side of the domain." },
  cut: { name: "Cut by the domain", means: "Bodies that reach a side of the domain." },
};

export const LEVEL_CARE: Record<Level, Care["level"]> = { error: "bad", warning: "look", note: "fine" };

// The kinds that have findings of a level, with how many each: "holes (4), thin walls (2)".
function kinds_of(findings: Findings, level: Level): string {
  const numbers = new Map<Kind, number>();
  for (const finding of findings.findings) if (finding.level === level) numbers.set(finding.kind, (numbers.get(finding.kind) ?? 0) + 1);
  return [...numbers].map(([kind, n]) => `${KINDS[kind].name.toLowerCase()} (${grouped(n)})`).join(", ");
}

// The verdict: what the worst findings are, and whether all was looked at. Only that is called fine.
export function verdict(findings: Findings): Care {
  const count = (level: Level) => findings.findings.filter((f) => f.level === level).length;
  const [errors, warnings, notes] = LEVELS.map(count) as [number, number, number];
  const listed = errors + warnings + notes;
  const all = Object.values(findings.totals).reduce((sum, total) => sum + (total?.findings ?? 0), 0);
  const more = all > listed ? ` ${grouped(all)} findings in all.` : "";
  const blind = findings.not_looked_at.length > 0;
  if (errors > 0) {
    const besides = warnings > 0 ? `, and ${plural(warnings, "warning")}` : "";
    return { level: "bad", text: `${plural(errors, "error")}: ${kinds_of(findings, "error")}${besides}.${more}` };
  }
  if (warnings > 0) return { level: "look", text: `${plural(warnings, "warning")}: ${kinds_of(findings, "warning")}.${more}` };
  const found = notes > 0 ? `No warnings, ${plural(notes, "note")}.${more}` : "Nothing was found.";
  return blind ? { level: "look", text: `${found} Not everything was looked at.` } : { level: "fine", text: found };
}

// The same of a grid that nobody has looked through: what the mesher says is not all.
export const not_checked = (care: Care): Care =>
  care.level === "fine" ? { level: "look", text: `Not checked yet. ${care.text}` } : care;
