// A bar whose length is a round number, at the distance that the camera looks at.
import { significant } from "../base/format";
import type { Projection } from "./camera";
import { element } from "./dom";

const LONGEST = 110; // pixels

// The largest of 1, 2 and 5 times a power of ten that is not longer.
export function round_length(longest: number): number {
  const power = 10 ** Math.floor(Math.log10(longest));
  return power * (longest >= 5 * power ? 5 : longest >= 2 * power ? 2 : 1);
}

export function make_scale_bar(units: string): { root: HTMLElement; update(view: Projection, distance: number, scale: number): void } {
  const text = element("span", {});
  const root = element("div", { class: "overview-scale", "aria-hidden": "true" }, text);
  return {
    root,
    // `distance` in the overview's space, in which a unit of length is `scale`.
    update(view, distance, scale) {
      const pixel = (2 * view.reach.y * distance) / (view.height * scale); // a length
      const length = round_length(LONGEST * pixel);
      if (!Number.isFinite(length)) return;
      root.style.width = `${(length / pixel).toFixed(1)}px`;
      text.textContent = `${significant(length, 3)} ${units}`;
    },
  };
}
