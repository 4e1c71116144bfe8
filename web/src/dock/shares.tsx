// What a mixed cell of level 0 is made of, where the file tells it.
import { type CellAnswer, type Index3, type Plane, type Share } from "../base/grid";
import { use_answer, use_settled } from "../server/answer";
import type { Viewer } from "../state/viewer";
import { Swatch } from "../widgets/swatch";
import { SETTLED } from "./profiles";

const NOTHING: { shares: Share[] | null; plane: Plane | null } = { shares: null, plane: null };

// Of a cell that is not mixed there is nothing to say.
export function use_shares(viewer: Viewer, cell: Index3 | null): typeof NOTHING {
  const wanted = viewer.has_shares && cell ? viewer.address.cell(cell) : null;
  const answer = use_answer<CellAnswer>(viewer.after_slices(use_settled(wanted, SETTLED)));
  if (!wanted || answer.path !== wanted) return NOTHING;
  const { shares, plane } = answer.value!;
  return shares && shares.length > 1 ? { shares, plane: plane ?? null } : NOTHING;
}

// As few digits as tell it from nothing and from all.
export function percent(share: number): string {
  const text = (100 * share).toFixed(1);
  return `${text === "0.0" ? "< 0.1" : text === "100.0" ? "> 99.9" : text} %`;
}

const LINES = 2; // there is room for so many

export function Shares({ viewer, shares }: { viewer: Viewer; shares: readonly Share[] }) {
  const largest_first = [...shares].sort((a, b) => b.share - a.share);
  const more = shares.length - LINES;
  return (
    <span class="material-names parts" title={largest_first.map(({ name, share }) => `${percent(share)} ${name}`).join(", ")}>
      {largest_first.slice(0, LINES).map(({ id, name, share }, n) => (
        <span key={id} class="material-name">
          <Swatch look={viewer.looks.value[id]} />
          <span class="part-percent">{percent(share)}</span>
          <span class="part-name">{name}</span>
          {n === LINES - 1 && more > 0 && <span class="part-rest faint">{more} more</span>}
        </span>
      ))}
    </span>
  );
}

const signed = (x: number): string => (Math.round(100 * x) === 0 ? "0" : x.toFixed(2).replace("-", "−"));

export function PlaneText({ plane }: { plane: Plane }) {
  return (
    <span class="dock-plane" title={`The normal of the surface of ${plane.name} in this cell, along x, y and z. It is estimated from the shares of the neighbours.`}>
      normal {plane.normal.map(signed).join(" ")}
    </span>
  );
}
