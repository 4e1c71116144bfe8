// The names and lengths of measured lines, above their middles, or below where another one is there. What finds no room is left out; the panel lists all.
import { label_of_measure } from "../state/measures";
import type { Measure, Viewer } from "../state/viewer";
import { element } from "./dom";
import { type Rect, apart, around } from "./numbers";
import { type Projection, project } from "./space/camera";
import { type Space, point_to_space } from "./space/space";

const ABOVE = 14; // pixels
const [CHARACTER, SIDES, HEIGHT] = [7, 10, 18]; // of a label, about

export function make_lengths(viewer: Viewer, space: Space) {
  const root = element("div", { class: "overview-lengths", "aria-hidden": "true" });
  return {
    root,
    update(view: Projection): void {
      const used: Rect[] = [];
      const is_chosen = (measure: Measure) => measure.id === viewer.chosen.value;
      const chosen_first = [...viewer.measures.value].sort((a, b) => Number(is_chosen(b)) - Number(is_chosen(a)));
      const texts = chosen_first.flatMap((measure) => {
        const { x, y, far } = project(view, point_to_space(space, measure.from.map((x, d) => (x + measure.to[d]!) / 2)));
        if (!(far > 0)) return [];
        const text = label_of_measure(measure, viewer.info.units);
        const places = [y - ABOVE, y + ABOVE].map((y) => ({ x, y, rect: around({ x, y }, [CHARACTER * text.length + SIDES, HEIGHT]) }));
        const free = places.find(({ rect }) => used.every((other) => apart(other, rect)));
        if (!free) return [];
        used.push(free.rect);
        return [{ x, y: free.y, text, chosen: is_chosen(measure) }];
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
