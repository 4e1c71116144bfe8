// A bar whose length is a round number, at the distance that the camera looks at.
import { length_text, round_length } from "../base/lengths";
import type { Projection } from "./space/camera";
import { element } from "./dom";

const LONGEST = 110; // pixels

export function make_scale_bar(units: string) {
  const text = element("span", {});
  const root = element("div", { class: "overview-scale", "aria-hidden": "true" }, text);
  return {
    root,
    // `distance` in the overview's space, in which a unit of length is `scale`.
    update(view: Projection, distance: number, scale: number) {
      const pixel = (2 * view.reach.y * distance) / (view.height * scale); // a length
      const length = round_length(LONGEST * pixel);
      if (!Number.isFinite(length)) return;
      root.style.width = `${(length / pixel).toFixed(1)}px`;
      text.textContent = length_text(length, units);
    },
  };
}
