// One slice view: its title, the picture, the bar below.
import { useLayoutEffect, useRef } from "preact/hooks";
import { coordinate, grouped, sizes } from "../base/format";
import { AXIS_NAMES, type AxisIndex } from "../base/grid";
import { connection } from "../server/connection";
import { answerer } from "../server/transport";
import type { ViewName, Viewer } from "../state/viewer";
import { toggle_layout } from "./actions";
import { Gestures } from "./gestures";
import { MaximiseButton } from "./maximise_button";
import { ObliquePanel } from "./oblique_panel";
import { SliceBar } from "./slice_bar";
import type { Stage } from "./stage";
import { ZoomButtons } from "./zoom_buttons";

// Handlers for a whole panel, including its bar: keys act on the panel that is in use.
export function activating(stage: Stage, view: ViewName) {
  const activate = () => stage.activate(view);
  return { onPointerEnter: activate, onPointerMove: activate, onFocusIn: activate };
}

function Title({ stage, viewer, axis }: { stage: Stage; viewer: Viewer; axis: AxisIndex }) {
  const waiting = stage.waiting[axis].value;
  const name = AXIS_NAMES[axis];
  const slice = viewer.slice[axis].value;
  const a = viewer.axes[axis];
  const level = viewer.level[axis].value;
  const together = Math.min(2 ** level, a.cells);
  const shares = viewer.has_shares && viewer.show_shares.value;
  const stale = connection.value.state === "lost" ? stage.stale[axis].value : null; // otherwise it goes in a moment
  return (
    <div class="view-title">
      <span class={`view-chip view-chip-${name}`} aria-hidden="true">
        {name}
      </span>
      {viewer.compared && <span class="view-grid">{viewer.info.id}</span>}
      <span class="view-place">
        {name} = {coordinate(a.centre(slice), a.width(slice))} {viewer.units}
      </span>
      <span class="view-slice">
        slice {grouped(slice)} (0–{grouped(a.cells - 1)})
      </span>
      {level > 0 && (
        <span
          class="view-level"
          title={`Each square shows the materials of ${sizes([together, together, together])} cells (level ${level}). Zoom in to see single cells${shares ? ", the mixed ones by their shares" : ""}.`}
        >
          level {level}
        </span>
      )}
      {shares && level === 0 && (
        <span class="view-level" title="A mixed cell has the mean colour of what is in it, by its shares. Press s to see each cell as one material.">
          shares
        </span>
      )}
      {stale !== null && (
        <span class="view-damaged" role="status" title={`Slice ${grouped(slice)} has not been loaded: ${answerer()} does not answer.`}>
          slice {grouped(stale)} is shown
        </span>
      )}
      {stage.damaged[axis].value && (
        <span
          class={level > 0 ? "view-damaged view-afar" : "view-damaged"}
          role="status"
          title={level > 0 ? "Zoomed in, more of it may be readable." : "This part of the file can't be read. “teracell verify” says what is damaged."}
        >
          <span class="view-wide">striped: </span>unreadable{level > 0 && " at this zoom"}
        </span>
      )}
      {stage.together[axis].value && viewer.body_looks.value.size > 0 && (
        <span class="view-level" role="status" title="Too many bodies are in sight. Zoom in to see which of them are hidden or coloured.">
          bodies not told apart
        </span>
      )}
      <span class={waiting ? "view-waiting" : "view-waiting view-still"} role="status" aria-label={waiting ? "Loading" : undefined} />
    </div>
  );
}

// `side`: where it stands in a comparison.
export function SlicePanel({ stage, viewer, axis, side }: { stage: Stage; viewer: Viewer; axis: AxisIndex; side?: "left" | "right" }) {
  const body = useRef<HTMLDivElement>(null);
  const name = AXIS_NAMES[axis];
  const layout = viewer.layout.value;
  useLayoutEffect(() => {
    const element = body.current!;
    const detach = stage.attach(axis, element);
    const gestures = new Gestures(stage, axis, element);
    return () => {
      gestures.stop();
      detach();
    };
  }, [stage, axis]);
  return (
    <section
      class="view-panel"
      data-view={name}
      data-side={side}
      hidden={layout !== "four" && layout !== name}
      aria-label={`Slices across ${name}${side ? ` of ${viewer.info.id}, ${side}` : ""}`}
      {...activating(stage, name)}
    >
      <div
        class={`view-body view-tool-${viewer.tool.value}`}
        ref={body}
        tabIndex={0}
        role="application"
        aria-roledescription="slice view"
        aria-label={`Slice ${viewer.slice[axis].value} across ${name}${side ? ` of ${viewer.info.id}, ${side}` : ""}; press h for its keys`}
      />
      <header class="view-head">
        <Title stage={stage} viewer={viewer} axis={axis} />
        {!side && <MaximiseButton what={`The view across ${name}`} alone={layout === name} toggle={() => toggle_layout(viewer, name)} />}
      </header>
      {side !== "left" && <ZoomButtons viewer={viewer} zoom={(factor) => stage.zoom_in_middle(axis, factor)} />}
      <SliceBar viewer={viewer} axis={axis} />
      {viewer.oblique.value === axis && <ObliquePanel stage={stage} viewer={viewer} axis={axis} />}
    </section>
  );
}
