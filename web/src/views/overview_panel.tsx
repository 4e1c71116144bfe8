// The fourth panel: the overview in three dimensions. Its code is loaded once the panel is in sight, after the slices.
import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { words_of } from "../base/messages";
import type { Viewer } from "../state/viewer";
import { toggle_layout } from "./actions";
import { MaximiseButton, activating } from "./panel";
import type { Stage } from "./stage";

export function OverviewPanel({ stage, viewer }: { stage: Stage; viewer: Viewer }) {
  const host = useRef<HTMLDivElement>(null);
  const trouble = useSignal<string | null>(null);
  const loading = useSignal(true);
  const attempt = useSignal(0);
  const layout = viewer.layout.value;
  const shown = layout === "four" || layout === "3d";
  const wanted = useSignal(shown);
  if (shown) wanted.value = true; // once loaded it stays, even while it is hidden
  const due = wanted.value && viewer.slices_shown.value;
  useEffect(() => {
    if (!due) return;
    let gone = false;
    let unmount = () => {};
    const load = async () => {
      try {
        const { mount_overview } = await import("../overview/overview");
        if (gone) return;
        unmount = mount_overview(host.current!, viewer);
        trouble.value = null;
      } catch (error) {
        trouble.value = words_of(error);
      }
      loading.value = false;
    };
    void load();
    return () => {
      gone = true;
      unmount();
    };
  }, [viewer, due, attempt.value]);
  const again = () => {
    trouble.value = null;
    loading.value = true;
    ++attempt.value;
  };
  return (
    <section class="view-panel" data-view="3d" hidden={!shown} aria-label="Overview in three dimensions" {...activating(stage, "3d")}>
      <div class="view-overview" ref={host} />
      {loading.value && <p class="view-note">Loading the overview …</p>}
      {trouble.value !== null && (
        <div class="view-note" role="alert">
          <p>The overview can't be shown: {trouble.value}.</p>
          <button onClick={again}>Try again</button>
        </div>
      )}
      <header class="view-head">
        <div class="view-title">
          <span class="view-chip view-chip-3d" aria-hidden="true">
            3D
          </span>
        </div>
        <MaximiseButton what="The overview" alone={layout === "3d"} toggle={() => toggle_layout(viewer, "3d")} />
      </header>
    </section>
  );
}
