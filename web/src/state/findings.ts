// The places of findings, as markers for the views.
import type { Findings } from "../base/findings";
import type { Marker } from "./viewer";

const MOST_MARKERS = 60;

// The worst first.
export const markers_of = ({ findings }: Findings): Marker[] =>
  findings.flatMap(({ at, text, box, kind }) => (at ? [{ at, text, ...(box && { box, guess: kind === "cap" }) }] : [])).slice(0, MOST_MARKERS);
