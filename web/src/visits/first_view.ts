// What is seen first where the address names no place: what there is, and not the middle of the air around it. The slices are asked for before that
// is known. Their views move when the answer has come soon, and never once somebody has moved them.
import { batch, effect } from "@preact/signals";
import { ranges_of, with_room } from "../state/boxes";
import type { Box, Viewer } from "../state/viewer";
import type { Range } from "../state/zoom";
import { box_and_nearest, middle_cell } from "./go_there";

const SOON = 1500; // milliseconds
const ROOM = 0.06; // around what there is, as a share of its longest side
const MUCH_SMALLER = 0.75; // of the domain: else that is what is framed

const PLACES = ["at", "look", "zoom", "orbit", "only", "compare"];
export const names_a_place = (query: URLSearchParams): boolean => PLACES.some((key) => query.has(key));

// The labels of all but the background and what is clear from the start.
export const what_there_is = (viewer: Pick<Viewer, "labels" | "standard_looks">): number[] =>
  viewer.labels.flatMap(({ material }, label) => (material !== 0 && viewer.standard_looks[material]!.opacity > 0 ? [label] : []));

// Whether a box should fill the views in place of the domain, of which it takes up little.
function deserves_frame(viewer: Viewer, box: Box): boolean {
  const longest = (ranges: readonly Range[]) => Math.max(...ranges.map(({ min, max }) => max - min));
  return longest(ranges_of(viewer.axes, box)) < MUCH_SMALLER * longest(viewer.axes);
}

// Until the slice views know their sizes, without which nothing can be framed in them.
function sized(viewer: Viewer): Promise<void> {
  return new Promise((done) => {
    const stop = effect(() => {
      if (viewer.zoom.value === 0 && viewer.views.length === 0 && viewer.layout.value !== "3d" && viewer.arriving.value) return;
      queueMicrotask(() => stop());
      done();
    });
  });
}

export async function show_what_there_is(viewer: Viewer, signal: AbortSignal): Promise<void> {
  const state = () => [viewer.cell.peek(), viewer.orbit.peek(), viewer.compare.peek(), viewer.isolated.peek(), viewer.visited.peek()];
  const before = state();
  const may_move = () => viewer.arriving.peek() && !signal.aborted && viewer.shows_all() && state().every((value, n) => value === before[n]);
  viewer.arriving.value = true;
  let stop_waiting = () => {};
  // Before the first slices are shown nobody sees that they move.
  const timer = setTimeout(() => (stop_waiting = effect(() => void (viewer.slices_shown.value && (viewer.arriving.value = false)))), SOON);
  try {
    const labels = what_there_is(viewer);
    const { box, cell } = labels.length > 0 ? await box_and_nearest(viewer, labels, undefined, signal) : { box: null, cell: null };
    if (!box) return;
    await sized(viewer);
    if (!may_move()) return;
    batch(() => {
      viewer.set_cell(cell ?? middle_cell(box));
      if (deserves_frame(viewer, box)) viewer.frame(with_room(viewer.axes, box, ROOM));
    });
  } finally {
    clearTimeout(timer);
    stop_waiting();
    viewer.arriving.value = false;
  }
}
