// Go there: what is looked at is isolated, all views frame it with some room, and the slices go through a cell of it.
import { batch } from "@preact/signals";
import type { Finding } from "../base/findings";
import { type Index3, type NearestAnswer, for_axes, without_overlap } from "../base/grid";
import { say, words_of } from "../base/messages";
import { get_json } from "../server/api";
import { with_room } from "../state/boxes";
import { labels_named, labels_of_overlap } from "../state/isolation";
import type { Box, Viewer } from "../state/viewer";

const ROOM = 0.15; // around a body, as a share of its longest side
const ROOM_OF_PLACE = 0.3; // around a finding or a difference, which says little without what is near it
const CELLS_AROUND = 8;

export const with_surroundings = ({ axes }: Viewer, place: Box) => with_room(axes, place, ROOM_OF_PLACE, CELLS_AROUND);

export const middle_cell = (box: Box): Index3 => for_axes((d) => (box[d] + box[d + 3]! - 1) >> 1);

// The box of some labels, and the cell of theirs that is nearest to a place, or else to its middle.
export const box_and_nearest = (viewer: Viewer, labels: readonly number[], to?: Index3, signal?: AbortSignal): Promise<NearestAnswer> =>
  get_json<NearestAnswer>(viewer.address.nearest(labels, to), signal);

// Puts the crosshair into a cell of the labels near a place, unless somebody moves on before that is known.
async function enter(viewer: Viewer, labels: readonly number[], to: Index3): Promise<void> {
  const here = viewer.cell.peek();
  const { cell } = await box_and_nearest(viewer, labels, to);
  if (cell && viewer.cell.peek() === here) viewer.set_cell(cell);
}

// Bodies, or materials where the file does not keep bodies apart.
export async function go_to_labels(viewer: Viewer, named: readonly number[]): Promise<void> {
  const labels = [...new Set(named.map((label) => without_overlap(viewer.labels, label)))].sort((a, b) => a - b);
  try {
    const { box, cell } = await box_and_nearest(viewer, labels.flatMap((label) => (viewer.labels[label + 1]?.overlap ? [label, label + 1] : [label])));
    if (!box) return say(`${labels.length === 1 ? "It owns" : "They own"} no cell, so there is no place to go to.`);
    batch(() => {
      // The background is around everything: it can't be shown alone.
      viewer.isolated.value = labels.some((label) => viewer.labels[label]!.material === 0) ? null : { labels, box: null };
      viewer.frame(with_room(viewer.axes, box, ROOM));
      viewer.set_cell(cell ?? middle_cell(box));
    });
  } catch (error) {
    say(`The place can't be looked for: ${words_of(error)}.`);
  }
}

// What was found is framed, not the bodies that it was found in. What has no place of its own is shown as these bodies. Of an overlap the
// cells of its owner that lie in other bodies are shown, where the file keeps them apart.
export function go_to_finding(viewer: Viewer, { at, box, bodies, kind }: Pick<Finding, "at" | "box" | "bodies"> & { kind?: Finding["kind"] }): void {
  const of_overlap = kind === "overlap" ? labels_of_overlap(viewer.info, bodies) : [];
  const labels = [...labels_named(viewer.info, bodies), ...of_overlap].sort((a, b) => a - b);
  if (!at) return void (labels.length && go_to_labels(viewer, labels));
  const cell = for_axes((d) => viewer.axes[d].clamp(viewer.axes[d].cell_at(at[d])));
  const place = box ?? ([...cell, ...cell.map((i) => i + 1)] as Box);
  batch(() => {
    viewer.isolated.value = { labels, box: place };
    viewer.set_cell(cell);
    if (of_overlap.length > 0) enter(viewer, of_overlap, middle_cell(place)).catch(() => {}); // it stays there
    viewer.frame(with_surroundings(viewer, place));
  });
}
