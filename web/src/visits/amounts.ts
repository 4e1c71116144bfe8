// How much of the grid everything fills, which the first view, the lists and the glass of the overview share. It comes from the index of a file, so
// it is cheap, unless axes are graded.
import type { Amount, Stats } from "../base/grid";
import { type Answer, use_answer } from "../server/answer";
import { get_json } from "../server/api";
import type { Viewer } from "../state/viewer";

async function load_stats(viewer: Viewer, signal?: AbortSignal): Promise<Stats> {
  return (viewer.stats.value ??= await get_json<Stats>(viewer.address.all_stats(), signal));
}

// By label.
export async function load_amounts(viewer: Viewer, signal?: AbortSignal): Promise<readonly Amount[]> {
  await load_stats(viewer, signal);
  return viewer.amounts!;
}

// For lists: what is known already, or is asked for once the slices have been shown.
export function use_stats(viewer: Viewer): Pick<Answer<Stats>, "value" | "error"> {
  const known = viewer.stats.value;
  const asked = use_answer<Stats>(known ? null : viewer.after_slices(viewer.address.all_stats()), (_, signal) => load_stats(viewer, signal));
  return known ? { value: known, error: null } : asked;
}
