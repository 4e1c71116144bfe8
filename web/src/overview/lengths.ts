// The lengths of measured lines, beside their middles.
import { length_text } from "../base/lengths";
import { length_of } from "../state/measures";
import type { Viewer } from "../state/viewer";
import { element } from "./dom";
import { type Projection, project } from "./space/camera";
import { type Space, point_to_space } from "./space/space";

const ABOVE = 14; // pixels

export function make_lengths(viewer: Viewer, space: Space) {
  const root = element("div", { class: "overview-lengths", "aria-hidden": "true" });
  return {
    root,
    update(view: Projection): void {
      const texts = viewer.measures.value.flatMap((measure) => {
        const middle = point_to_space(space, measure.from.map((x, d) => (x + measure.to[d]!) / 2));
        const { x, y, far } = project(view, middle);
        return far > 0 ? [{ x, y: y - ABOVE, text: length_text(length_of(measure), viewer.info.units, 5), chosen: measure.id === viewer.chosen.value }] : [];
      });
      while (root.childElementCount > texts.length) root.lastElementChild!.remove();
      while (root.childElementCount < texts.length) root.append(element("span", { class: "overview-length" }));
      texts.forEach(({ x, y, text, chosen }, n) => {
        const label = root.children[n] as HTMLElement;
        label.textContent = text;
        label.classList.toggle("chosen", chosen);
        label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
      });
    },
  };
}
