// Keeps the three coarse slices up to date. It asks for a slice when the crosshair has moved to another one of its
// level, and colours it when it comes. There is at most one request per axis. When it ends, the slice that is wanted by
// then comes next.
import type { AxisIndex } from "../base/grid";
import { get } from "../server/api";
import type { Viewer } from "../state/viewer";
import { type Picture, type Slice, decode_slice, slice_picture, slice_place } from "./slice_picture";

export interface SliceSource {
  // Asks for what is missing. Called when the overview has time.
  update(): void;
}

export function follow_slices(
  viewer: Viewer,
  signal: AbortSignal,
  show: (axis: AxisIndex, picture: Picture) => void,
  failed: (error: unknown) => void,
): SliceSource {
  const slots = ([0, 1, 2] as const).map((axis) => ({ axis, shown: -1, asking: false, slice: null as Slice | null, looks: viewer.looks.value }));

  const update = () => {
    for (const slot of slots) {
      const place = slice_place(viewer.axes, slot.axis, viewer.cell.value[slot.axis], viewer.info.levels.length);
      if (slot.slice && slot.looks !== viewer.looks.value) paint(slot);
      if (slot.asking || slot.shown === place.index) continue;
      slot.asking = true;
      get(viewer.address.tile(slot.axis, place.index, place.level, 0, 0), { signal, priority: "low" })
        .then(async (response) => {
          slot.slice = decode_slice(viewer.axes, place, await response.arrayBuffer());
          slot.shown = place.index;
          slot.asking = false;
          paint(slot);
          update();
        })
        .catch((error: unknown) => {
          slot.asking = false;
          if (!signal.aborted) failed(error);
        });
    }
  };
  const paint = (slot: (typeof slots)[number]) => {
    slot.looks = viewer.looks.value;
    show(slot.axis, slice_picture(viewer.axes, slot.slice!, slot.looks));
  };
  return { update };
}
