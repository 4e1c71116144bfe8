// The four panels: the slices across z, x and y, and the overview. The panels of z and y stand one above the other and
// have x in common; those of x and y stand side by side and have z in common.
import { useLayoutEffect, useMemo, useRef } from "preact/hooks";
import type { AxisIndex } from "../base/grid";
import { unfinished } from "../state/measures";
import { by_touch } from "../state/phone";
import type { Viewer } from "../state/viewer";
import { IsolatedNote } from "./isolated_note";
import { attach_keys } from "./keys";
import { OverviewPanel } from "./overview_panel";
import { SlicePanel } from "./panel";
import { Stage } from "./stage";
import { attach_sweep } from "./sweep";
import { expose } from "./testing";
import "./views.css";

const ORDER: readonly AxisIndex[] = [2, 0, 1];

function measuring_words(viewer: Viewer): string {
  const { layout } = viewer;
  if (unfinished(viewer)?.axis === null) return "Click a surface at the other end";
  if (layout.value === "3d") return "Click a surface at each end, or shift and click for the thickness";
  return layout.value === "four" ? "Drag a line in a slice, or click both ends in 3D" : `Drag from end to end${by_touch ? "" : " (with alt it doesn't snap)"}`;
}

// Says what the mouse does now. The shape of the pointer would not be enough, and there is none on touch screens.
export function ToolNote({ viewer }: { viewer: Viewer }) {
  const tool = viewer.tool.value;
  return (
    <p class="tool-note" role="status" hidden={tool === "look"}>
      {tool === "measure" ? measuring_words(viewer) : "Drag a box in a slice"}.{!by_touch && " Escape stops."}
    </p>
  );
}

// The first stop of the tab key in the views: the panel comes after all of them.
function SkipToPanel({ viewer }: { viewer: Viewer }) {
  const skip = () => {
    const panel = (viewer.panel.value ??= "materials");
    setTimeout(() => document.getElementById(`tab-${panel}`)?.focus()); // once it is there
  };
  return (
    <button class="button skip" onClick={skip}>
      Skip to the panel
    </button>
  );
}

export function Views({ viewer }: { viewer: Viewer }) {
  const host = useRef<HTMLDivElement>(null);
  const stage = useMemo(() => new Stage(viewer), [viewer]);
  // Before the browser draws the page for the first time: the sooner tiles are asked for, the better.
  useLayoutEffect(() => {
    const stops = [stage.start(host.current!), attach_keys(() => stage), attach_sweep(stage), expose(stage)];
    return () => stops.forEach((stop) => stop());
  }, [stage]);
  return (
    <div class="views" data-layout={viewer.layout.value} ref={host}>
      <SkipToPanel viewer={viewer} />
      {ORDER.map((axis) => (
        <SlicePanel key={axis} stage={stage} viewer={viewer} axis={axis} />
      ))}
      <OverviewPanel stage={stage} viewer={viewer} />
      <div class="view-notes">
        <IsolatedNote viewer={viewer} />
        <ToolNote viewer={viewer} />
      </div>
    </div>
  );
}
