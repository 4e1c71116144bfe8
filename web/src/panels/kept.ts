// What people have unfolded in a panel, or folded, and where they have scrolled it to, is so again when the panel comes back: on phones,
// "Go there" puts it away.
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import type { Panel, Viewer } from "../state/viewer";

const kept = new WeakMap<Viewer, Map<string, boolean>>();
const scrolled = new WeakMap<Viewer, Map<Panel, number>>();

export function use_unfolded(viewer: Viewer, name: string, at_first: boolean): [boolean, (now: boolean) => void] {
  const [unfolded, set_unfolded] = useState(kept.get(viewer)?.get(name) ?? at_first);
  const set = (now: boolean) => {
    if (!kept.has(viewer)) kept.set(viewer, new Map());
    kept.get(viewer)!.set(name, now);
    set_unfolded(now);
  };
  return [unfolded, set];
}

const COMES = 2000; // milliseconds in which what a panel asks for makes room

export function use_scrolled(viewer: Viewer, panel: Panel | null) {
  const content = useRef<HTMLDivElement>(null);
  useLayoutEffect(() => {
    const element = content.current;
    if (!element || panel === null) return;
    const all = scrolled.get(viewer) ?? new Map<Panel, number>();
    scrolled.set(viewer, all);
    const to = all.get(panel) ?? 0;
    const over = new AbortController();
    const { signal } = over;
    const put = () => (element.scrollTop = to);
    const coming = new MutationObserver(put);
    const settle = () => {
      coming.disconnect();
      element.style.removeProperty("overflow-anchor");
    };
    if (to > 0) {
      element.style.setProperty("overflow-anchor", "none"); // what comes above moves nothing
      coming.observe(element, { childList: true, subtree: true });
      put();
      setTimeout(settle, COMES);
      for (const type of ["pointerdown", "wheel", "keydown"]) element.addEventListener(type, settle, { signal, passive: true });
    }
    element.addEventListener("scroll", () => all.set(panel, element.scrollTop), { signal });
    return () => {
      over.abort();
      settle();
    };
  }, [viewer, panel]);
  return content;
}
