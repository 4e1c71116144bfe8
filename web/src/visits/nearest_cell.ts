// The cell nearest to a place that has one of some labels: the server looks for it.
import type { Index3, NearestAnswer } from "../base/grid";
import { get_json } from "../server/api";
import type { Viewer } from "../state/viewer";

const MOST = 1000; // labels in an address. A cell of one of so many will do.

// Null when no cell has one.
export async function nearest_cell(viewer: Viewer, labels: readonly number[], to: Index3, signal?: AbortSignal): Promise<Index3 | null> {
  return (await get_json<NearestAnswer>(viewer.address.nearest(labels.slice(0, MOST), to), signal)).cell;
}
