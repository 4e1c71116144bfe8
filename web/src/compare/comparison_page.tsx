// What the page shows while two slices are compared, in place of the views and the read-out.
import { type Signal, signal } from "@preact/signals";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { GridInfo, GridSummary } from "../base/grid";
import { use_answer } from "../server/answer";
import type { Comparison, Viewer } from "../state/viewer";
import { SlicePanel } from "../views/panel";
import type { Stage } from "../views/stage";
import { ToolNote } from "../views/views";
import "../views/views.css";
import { ComparisonBar } from "./comparison_bar";
import "./compare.css";
import { ComparedPoint, ComparedSpaces } from "./compared_spaces";
import { ComparedPlace } from "./compared_place";
import { show_differences } from "./difference_picture";
import { OtherPointer } from "./other_pointer";
import { type GoneTo, Pair } from "./pair";
import { WholeDifference } from "./whole_difference";
import { WipeHandle } from "./wipe_handle";

type OpenComparison = Signal<Comparison>;

function Slices({ pair, comparison }: { pair: Pair; comparison: OpenComparison }) {
  const host = useRef<HTMLDivElement>(null);
  const { axis, mode, wipe } = comparison.value;
  useEffect(() => pair.start(host.current!), [pair]);
  useEffect(() => (mode === "differs" ? show_differences(pair, comparison) : undefined), [pair, axis, mode]);
  // Keys act on the side that has the pointer or the focus.
  const use = (event: Event) => {
    const side = (event.target as Element).closest<HTMLElement>("[data-side]")?.dataset.side;
    if (side) pair.in_use = side === "left" ? pair.left : pair.right;
  };
  const panel = (stage: Stage, side: "left" | "right") => (
    <SlicePanel key={`${side} ${axis}`} stage={stage} viewer={stage.viewer} axis={axis} side={side} />
  );
  return (
    <div
      class="views comparison-views"
      data-mode={mode}
      style={{ "--wipe": `${100 * wipe}%` }}
      ref={host}
      onPointerOverCapture={use}
      onFocusInCapture={use}
    >
      {panel(pair.left, "left")}
      {panel(pair.right, "right")}
      {mode === "wipe" && <WipeHandle comparison={comparison} />}
      {mode === "side" && <OtherPointer pair={pair} axis={axis} />}
      <ToolNote viewer={pair.left.viewer} />
    </div>
  );
}

function Opened({ viewer, comparison, info }: { viewer: Viewer; comparison: OpenComparison; info: GridInfo }) {
  const { space } = comparison.value;
  const gone_to = useMemo((): GoneTo => ({ box: signal(null), visited: signal(null) }), [viewer, info]);
  const pair = useMemo(() => new Pair(viewer, info, gone_to), [viewer, info, space]);
  return (
    <>
      <main class="views-area" aria-label={space ? "Grids that are compared" : "Slices that are compared"}>
        {space ? <ComparedSpaces pair={pair} comparison={comparison} /> : <Slices pair={pair} comparison={comparison} />}
      </main>
      {space ? <ComparedPoint pair={pair} comparison={comparison} /> : <ComparedPlace pair={pair} comparison={comparison} />}
      <aside class={`side-panel comparison-panel ${viewer.panel.value ? "" : "collapsed"}`} id="side-panel" aria-label="What differs">
        <WholeDifference pair={pair} comparison={comparison} info={info} />
      </aside>
    </>
  );
}

// `grids`: those that are served; null while they are not known.
export function ComparisonPage({ viewer, grids }: { viewer: Viewer; grids: readonly GridSummary[] | null }) {
  const comparison = viewer.compare as OpenComparison; // the page shows this while it is open
  const { other } = comparison.value;
  const summary = grids?.find(({ id }) => id === other);
  const path = summary ? `api/v1/grids/${encodeURIComponent(other)}?v=${summary.hash}` : null;
  const answer = use_answer<GridInfo>(path);
  const info = answer.path === path ? answer.value : null;
  return (
    <div class="workspace comparison">
      <ComparisonBar viewer={viewer} comparison={comparison} grids={grids ?? []} />
      {info && <Opened key={`${other} ${info.file.hash}`} viewer={viewer} comparison={comparison} info={info} />}
      {!info && <aside class="side-panel comparison-panel collapsed" id="side-panel" aria-label="What differs" />}
      {!info && (
        <main class="comparison-note" aria-busy={!answer.error}>
          {grids && !summary && <p role="alert">There is no grid “{other}” here. Choose another one above.</p>}
          {summary && answer.error && (
            <p role="alert">
              “{other}” can't be opened: {answer.error}.
            </p>
          )}
        </main>
      )}
    </div>
  );
}
