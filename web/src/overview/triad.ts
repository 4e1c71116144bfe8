// The triad in the corner: the axes as the camera sees them. Its ends are buttons that look along the axis from there.
// Near ends lie over far ones.
import { AXIS_NAMES } from "../base/grid";
import type { Projection } from "./camera";
import { element } from "./dom";

const ARM = 30; // pixels

export interface Triad {
  readonly root: HTMLElement;
  update(view: Projection): void;
}

export function make_triad(look_from: (axis: number, from_above: boolean) => void): Triad {
  const root = element("div", { class: "overview-triad", role: "group", "aria-label": "Views along the axes" });
  const ends = ([0, 1, 2] as const).flatMap((axis) =>
    [true, false].map((upper) => {
      const name = AXIS_NAMES[axis];
      const label = `Look along ${upper ? "−" : "+"}${name}, from the ${upper ? "upper" : "lower"} end of ${name}`;
      const button = element(
        "button",
        { type: "button", class: `overview-end ${name} ${upper ? "upper" : "lower"}`, "aria-label": label, title: label },
        upper ? name : "",
      );
      button.addEventListener("click", () => look_from(axis, upper));
      const arm = upper ? element("div", { class: `overview-arm ${name}` }) : null;
      root.append(...(arm ? [arm, button] : [button]));
      return { axis, sign: upper ? 1 : -1, button, arm };
    }),
  );
  return {
    root,
    update({ right, up, back }) {
      for (const { axis, sign, button, arm } of ends) {
        const [x, y, near] = [sign * right[axis]!, -sign * up[axis]!, sign * back[axis]!];
        button.style.transform = `translate(${x * ARM}px, ${y * ARM}px)`;
        button.style.zIndex = String(Math.round(10 + 8 * near));
        if (!arm) continue;
        arm.style.transform = `rotate(${Math.atan2(y, x)}rad) scaleX(${Math.hypot(x, y)})`;
        arm.style.zIndex = String(Math.round(10 + 8 * Math.min(near, 0)) - 1);
      }
    },
  };
}
