// What people have unfolded in a panel, or folded, is so again when the panel comes back: on phones, "Go there" puts it away.
import { useState } from "preact/hooks";
import type { Viewer } from "../state/viewer";

const kept = new WeakMap<Viewer, Map<string, boolean>>();

export function use_unfolded(viewer: Viewer, name: string, at_first: boolean): [boolean, (now: boolean) => void] {
  const [unfolded, set_unfolded] = useState(kept.get(viewer)?.get(name) ?? at_first);
  const set = (now: boolean) => {
    if (!kept.has(viewer)) kept.set(viewer, new Map());
    kept.get(viewer)!.set(name, now);
    set_unfolded(now);
  };
  return [unfolded, set];
}
