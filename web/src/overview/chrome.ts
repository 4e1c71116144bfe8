// The elements of the overview: its canvas, its buttons, and messages about what is missing.
import { BODY_MODES, type BodyMode } from "../state/viewer";
import type { Sky } from "./space/camera";
import { element } from "./dom";

const MODES: Record<BodyMode, { text: string; title: string }> = {
  cut: { text: "Cut", title: "Cut the bodies open at the crosshair" },
  plane: { text: "Plane", title: "Cut the bodies by a plane through the crosshair that faces you; press again to turn the plane" },
  whole: { text: "Whole", title: "Show the bodies whole" },
  glass: { text: "Glass", title: "Show the bodies as glass" },
};
const HELP =
  "3D overview. The arrow keys turn it, plus and minus move closer or farther away, Home shows everything. A click selects a cell, a double click goes there.";

export type Chrome = ReturnType<typeof make_chrome>;

export function make_chrome(host: HTMLElement) {
  const canvas = element("canvas", { tabindex: "0", role: "application", "aria-label": HELP });
  const home = element("button", { type: "button", title: "Show everything (Home)", "aria-label": "Show everything" });
  home.innerHTML =
    '<svg viewBox="0 0 16 16" width="14" height="14" aria-hidden="true"><path d="M2 8 8 2.5 14 8M4 6.8V13h8V6.8" fill="none"' +
    ' stroke="currentColor" stroke-width="1.5" stroke-linejoin="round" stroke-linecap="round"/></svg>';
  const sky = element("button", { type: "button", class: "overview-sky" });
  const modes = BODY_MODES.map((mode) => ({ mode, button: element("button", { type: "button", title: MODES[mode].title }, MODES[mode].text) }));
  const bar = element(
    "div",
    { class: "overview-bar", role: "toolbar", "aria-label": "Overview" },
    home,
    sky,
    element("div", { class: "overview-modes", role: "group", "aria-label": "Bodies" }, ...modes.map((m) => m.button)),
  );
  const busy = element("div", { class: "overview-busy", role: "status" });
  const message = element("div", { class: "overview-message", role: "alert" });
  message.hidden = true;
  const root = element("div", { class: "overview" }, canvas, bar, busy, message);
  host.append(root);

  const say = (text: string, again?: () => void) => {
    message.hidden = text === "";
    message.replaceChildren(text);
    if (!again) return;
    const button = element("button", { type: "button" }, "Try again");
    button.addEventListener("click", () => {
      say("");
      again();
    });
    message.append(" ", button);
  };
  return {
    root,
    canvas,
    say,
    home,
    modes,
    sky,
    busy,
    show_sky(up: Sky) {
      sky.textContent = `${"xyz"[up]} is up`;
      sky.title = `${"xyz"[up]} is up: press for ${up === 2 ? "y" : "z"}`;
      sky.setAttribute("aria-label", sky.title);
    },
    show_mode(shown: BodyMode) {
      for (const { mode, button } of modes) button.setAttribute("aria-pressed", String(mode === shown));
    },
  };
}
