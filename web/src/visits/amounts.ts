// How much of the grid everything fills, which the lists and the glass of the overview share. A file tells it; an older one, or one with
// graded axes, has it counted from its index.
import type { Stats } from "../base/grid";
import { type Answer, use_answer } from "../server/answer";
import { get_json } from "../server/api";
import type { Viewer } from "../state/viewer";

async function load_stats(viewer: Viewer, signal?: AbortSignal): Promise<Stats> {
  return (viewer.stats.value ??= await get_json<Stats>(viewer.address.all_stats(), signal));
}

// What is known already or, where it is wanted, is asked for once the slices have been shown.
export function use_stats(viewer: Viewer, wanted = true): Pick<Answer<Stats>, "value" | "error"> {
  const known = viewer.stats.value;
  const asked = use_answer<Stats>(known || !wanted ? null : viewer.after_slices(viewer.address.all_stats()), (_, signal) => load_stats(viewer, signal));
  return known ? { value: known, error: null } : asked;
}
