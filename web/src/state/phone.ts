// On a phone there is room for one view at a time, and the panel is a sheet that begins closed. style/phone.css has the same width.
import { effect, signal } from "@preact/signals";
import type { Viewer } from "./viewer";

const narrow = matchMedia("(max-width: 600px)");
export const on_phone = signal(narrow.matches);
narrow.addEventListener("change", () => (on_phone.value = narrow.matches));

// Whether there is neither a mouse nor a trackpad.
export const by_touch = matchMedia("(hover: none)").matches;

// Returns a function that ends it. Whatever asks for all four views, such as a link, gets one of them.
export function keep_to_one_view(viewer: Viewer): () => void {
  if (on_phone.value && viewer.panel.value === "materials") viewer.panel.value = null; // the panel that nobody asked for
  let last: "x" | "y" | "z" | "3d" = "z";
  const stops = [
    effect(() => {
      const layout = viewer.layout.value;
      if (layout !== "four") last = layout;
      else if (on_phone.value) viewer.layout.value = last;
    }),
    // The panel would lie over what was gone to from it.
    effect(() => {
      if (viewer.isolated.value && on_phone.value) viewer.panel.value = null;
    }),
  ];
  return () => stops.forEach((stop) => stop());
}
