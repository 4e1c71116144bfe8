// What keys and buttons do to the views.
import { batch } from "@preact/signals";
import type { AxisIndex } from "../base/grid";
import type { ViewName, Viewer } from "../state/viewer";

// Shows one view alone, or all four again.
export function toggle_layout(viewer: Viewer, view: ViewName): void {
  viewer.layout.value = viewer.layout.value === "four" ? view : "four";
}

export function toggle_sweep(viewer: Viewer, axis: AxisIndex): void {
  viewer.sweeping.value = viewer.sweeping.value === axis ? null : axis;
}

// Shows the whole grid in all views.
export function fit(viewer: Viewer): void {
  batch(() => {
    viewer.centre.value = viewer.middle();
    viewer.zoom.value = 0;
  });
}

// Takes one step back: puts the tool away, or else removes the measured line, the box or the pin.
export function escape(viewer: Viewer): void {
  batch(() => {
    viewer.sweeping.value = null;
    if (viewer.tool.value !== "look") {
      viewer.tool.value = "look";
      return;
    }
    if (viewer.measure.value) viewer.measure.value = null;
    else if (viewer.box.value) viewer.box.value = null;
    else viewer.pinned.value = null;
  });
}
