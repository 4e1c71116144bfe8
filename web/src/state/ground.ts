// The ground of the views: the theme's own, or another one when the theme's would swallow a material that is shown.
import { effect } from "@preact/signals";
import { needs_other_ground } from "../base/contrast";
import { theme } from "./theme";
import type { Viewer } from "./viewer";

// Keeps the page's ground as the open grid needs it: the style sheets ask for [data-ground="other"]. Returns a function that ends this.
export function keep_ground(viewer: Viewer): () => void {
  const page = document.documentElement;
  const stop = effect(() => {
    const seen = viewer.label_looks.value.filter((look) => look.visible && look.opacity > 0.5);
    page.dataset.ground = needs_other_ground(theme.value, seen.map((look) => look.color)) ? "other" : "usual";
  });
  return () => {
    stop();
    delete page.dataset.ground;
  };
}
