// Measuring on surfaces: one click for each end of a line, while drags turn the view as always; with shift, a click measures how thick the
// material is there, along the surface's normal.
import { batch } from "@preact/signals";
import { drop, say, words_of } from "../base/messages";
import { length_of, next_id, put_measure, unfinished } from "../state/measures";
import type { Viewer } from "../state/viewer";
import { type Seen, fetch_thickness } from "./sight/query";

type Point = [number, number, number];

const NOTHING = "Nothing is seen there to measure from: click a body.";
const NO_SURFACE = "This is where the view cuts the material, not its surface: there is no normal to measure along.";

// `changed`: is called for each line that is drawn here.
export function make_measuring(viewer: Viewer, signal: AbortSignal, changed: () => void) {
  const begun = () => {
    const line = unfinished(viewer);
    return line?.axis === null ? line : null;
  };
  const put = (from: Point, to: Point, name = "") => {
    [NOTHING, NO_SURFACE].forEach(drop); // what went wrong before
    put_measure(viewer, { id: begun()?.id ?? next_id(viewer.measures.value), name, axis: null, from, to });
    changed();
  };
  const end = () => {
    viewer.measuring.value = null;
    viewer.tool.value = "look";
    viewer.panel.value = "box";
  };

  return {
    click(seen: Seen | null): void {
      if (!seen) return say(NOTHING);
      batch(() => {
        const line = begun();
        if (line && length_of({ from: line.from, to: [...seen.at] }) === 0) return; // the second click of a double click
        viewer.thickness.value = null;
        put(line?.from ?? [...seen.at], [...seen.at]);
        if (line) end();
        else viewer.measuring.value = viewer.chosen.value;
      });
    },

    // The line that has no end yet follows the pointer.
    move(point: Point | null): void {
      const line = begun();
      if (line && point) put(line.from, point);
    },

    async thickness(seen: Seen | null): Promise<void> {
      if (!seen) return say(NOTHING);
      try {
        const thickness = await fetch_thickness(seen, signal);
        if (!thickness) return say(NO_SURFACE);
        batch(() => {
          viewer.thickness.value = null;
          put(thickness.from, thickness.to, `Thickness of ${thickness.name}`);
          end();
        });
      } catch (error) {
        if (!signal.aborted) say(`The thickness can't be measured: ${words_of(error)}.`);
      }
    },
  };
}
