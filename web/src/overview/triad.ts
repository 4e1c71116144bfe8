// The triad in the corner: the axes as the camera sees them. Its ends are buttons that look along the axis from there.
// Where two of them meet, the one with a name stays, or else the nearer one.
import { AXIS_NAMES } from "../base/grid";
import type { Projection } from "./space/camera";
import { element } from "./dom";

const ARM = 40; // pixels
const APART = 24; // pixels between ends that can both be hit: WCAG 2.2, 2.5.8

export function make_triad(look_from: (axis: number, from_above: boolean) => void) {
  const root = element("div", { class: "overview-triad", role: "group", "aria-label": "Views along the axes" });
  const ends = ([0, 1, 2] as const).flatMap((axis) =>
    [true, false].map((upper) => {
      const name = AXIS_NAMES[axis];
      const label = `Look along ${upper ? "−" : "+"}${name}, from the ${upper ? "upper" : "lower"} end of ${name}`;
      const button = element(
        "button",
        { type: "button", class: `overview-end ${name} ${upper ? "upper" : "lower"}`, "aria-label": label, title: label },
        element("span", { class: "overview-ball" }, upper ? name : ""),
      );
      button.addEventListener("click", () => look_from(axis, upper));
      const arm = upper ? element("div", { class: `overview-arm ${name}` }) : null;
      root.append(...(arm ? [arm, button] : [button]));
      return { axis, sign: upper ? 1 : -1, button, arm };
    }),
  );
  return {
    root,
    update({ right, up, back }: Projection) {
      const places = ends.map(({ axis, sign }) => ({ x: sign * right[axis]!, y: -sign * up[axis]!, near: sign * back[axis]! }));
      const over = (a: number, b: number) => ends[a]!.sign - ends[b]!.sign || places[a]!.near - places[b]!.near || b - a; // above 0: a covers b
      const meet = (a: number, b: number) => ARM * Math.max(Math.abs(places[a]!.x - places[b]!.x), Math.abs(places[a]!.y - places[b]!.y)) < APART;
      const covered = (n: number) => places.some((_, other) => over(other, n) > 0 && meet(other, n));
      for (const [n, { button, arm }] of ends.entries()) {
        const { x, y, near } = places[n]!;
        button.style.visibility = covered(n) ? "hidden" : "";
        button.style.transform = `translate(${x * ARM}px, ${y * ARM}px)`;
        button.style.zIndex = String(Math.round(10 + 8 * near));
        if (!arm) continue;
        arm.style.transform = `rotate(${Math.atan2(y, x)}rad) scaleX(${Math.hypot(x, y)})`;
        arm.style.zIndex = String(Math.round(10 + 8 * Math.min(near, 0)) - 1);
      }
    },
  };
}
