// The overview in three dimensions: the fourth panel, or one of those that are compared. Its code is loaded once the panel is in sight, after the slices.
import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { words_of } from "../base/messages";
import type { Viewer } from "../state/viewer";
import { use_stats } from "../visits/amounts";
import { toggle_layout } from "./actions";
import { MaximiseButton } from "./maximise_button";
import { activating } from "./panel";
import type { Stage } from "./stage";

interface OverviewProps {
  stage: Stage;
  viewer: Viewer;
  side?: "left" | "right"; // of a comparison
  title?: string;
  against?: Viewer; // what differs from it is shown, in place of the bodies
  cut_by?: Viewer; // at whose crosshair bodies are cut
}

export function OverviewPanel({ stage, viewer, side, title, against, cut_by }: OverviewProps) {
  const host = useRef<HTMLDivElement>(null);
  const state = useSignal<"loading" | "there" | { readonly trouble: string; readonly loaded: boolean }>("loading");
  const attempt = useSignal(0);
  const layout = viewer.layout.value;
  const shown = layout === "four" || layout === "3d";
  const wanted = useSignal(shown);
  if (shown) wanted.value = true; // once loaded it stays, even while it is hidden
  const due = wanted.value && viewer.slices_shown.value;
  use_stats(viewer, viewer.bodies.value === "glass"); // glass shows small bodies solid
  useEffect(() => {
    if (!due) return;
    let gone = false;
    let unmount = () => {};
    const load = async () => {
      let loaded = false;
      try {
        const { mount_overview } = await import("../overview/overview");
        loaded = true;
        if (gone) return;
        const mounted = mount_overview(host.current!, viewer, { against, cut_by });
        stage.overview_keys = mounted.keys;
        unmount = mounted.unmount;
        state.value = "there";
      } catch (error) {
        state.value = { trouble: words_of(error), loaded };
      }
    };
    void load();
    return () => {
      gone = true;
      stage.overview_keys = null;
      unmount();
    };
  }, [stage, viewer, against, cut_by, due, attempt.value]);
  // What a browser could not load it does not load again for the same page. The address has all that is seen.
  const again = () => {
    if (typeof state.value === "object" && !state.value.loaded) return location.reload();
    state.value = "loading";
    ++attempt.value;
  };
  return (
    <section class="view-panel" data-view="3d" data-side={side} hidden={!shown} aria-label="Overview in three dimensions" {...activating(stage, "3d")}>
      <div class="view-overview" ref={host} />
      {state.value === "loading" && <p class="view-note">Loading the overview …</p>}
      {typeof state.value === "object" && (
        <div class="view-note" role="alert">
          <p>The overview can't be shown: {state.value.trouble}.</p>
          <button onClick={again}>{state.value.loaded ? "Try again" : "Load the page again"}</button>
        </div>
      )}
      <header class="view-head">
        <div class="view-title">
          <span class="view-chip view-chip-3d" aria-hidden="true">
            3D
          </span>
          {title && <span class="view-grid">{title}</span>}
        </div>
        {!viewer.compared && <MaximiseButton what="The overview" alone={layout === "3d"} toggle={() => toggle_layout(viewer, "3d")} />}
      </header>
    </section>
  );
}
