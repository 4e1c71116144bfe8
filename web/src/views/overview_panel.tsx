// The overview in three dimensions: the fourth panel, or one of those that are compared. Its code is loaded once the panel is in sight, after the slices.
import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { words_of } from "../base/messages";
import type { Viewer } from "../state/viewer";
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
  const state = useSignal<"loading" | "there" | { readonly trouble: string }>("loading");
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
        const mounted = mount_overview(host.current!, viewer, { against, cut_by });
        stage.overview_keys = mounted.keys;
        unmount = mounted.unmount;
        state.value = "there";
      } catch (error) {
        state.value = { trouble: words_of(error) };
      }
    };
    void load();
    return () => {
      gone = true;
      stage.overview_keys = null;
      unmount();
    };
  }, [stage, viewer, against, cut_by, due, attempt.value]);
  const again = () => {
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
          <button onClick={again}>Try again</button>
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
