// Two grids in three dimensions, with one camera: side by side, one on the other, or what differs between them.
import type { Signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { coordinate } from "../base/format";
import { AXES, AXIS_NAMES } from "../base/grid";
import { unequal_cells } from "../state/comparison";
import type { Comparison } from "../state/viewer";
import { OverviewPanel } from "../views/overview_panel";
import { ToolNote } from "../views/views";
import { DifferenceMarks } from "./compared_place";
import type { Pair } from "./pair";
import { WipeHandle } from "./wipe_handle";

export function ComparedSpaces({ pair, comparison }: { pair: Pair; comparison: Signal<Comparison> }) {
  const host = useRef<HTMLDivElement>(null);
  const { mode, wipe } = comparison.value;
  const { left, right } = pair;
  useEffect(() => pair.start(host.current!), [pair]);
  // Keys act on the side that has the pointer or the focus.
  const use = (event: Event) => {
    const side = (event.target as Element).closest<HTMLElement>("[data-side]")?.dataset.side;
    if (side) pair.in_use = side === "left" ? left : right;
  };
  const panel = (side: "left" | "right") => (
    <OverviewPanel key={side} stage={pair[side]} viewer={pair[side].viewer} side={side} title={pair[side].viewer.info.id} cut_by={left.viewer} />
  );
  return (
    <div class="views comparison-spaces" data-mode={mode} style={{ "--wipe": `${100 * wipe}%` }} ref={host} onPointerOverCapture={use} onFocusInCapture={use}>
      {mode === "differs" ? (
        <OverviewPanel key="differs" stage={left} viewer={left.viewer} side="left" title="what differs" against={right.viewer} />
      ) : (
        [panel("left"), panel("right")]
      )}
      {mode === "wipe" && <WipeHandle comparison={comparison} />}
      <ToolNote viewer={left.viewer} />
    </div>
  );
}

// Where the pointer is, and what the colours mean.
export function ComparedPoint({ pair, comparison }: { pair: Pair; comparison: Signal<Comparison> }) {
  const { left, right } = pair;
  const hover = left.viewer.hover.value ?? right.viewer.hover.value;
  return (
    <section class="compared" aria-label="Read-out">
      <div class="compared-place">
        <span class="faint">Pointer</span>
        {AXES.map((d) => (
          <span key={d}>
            {AXIS_NAMES[d]} = {hover ? `${coordinate(hover.point[d], left.viewer.axes[d].finest)} ${left.viewer.units}` : "–"}
          </span>
        ))}
      </div>
      {comparison.value.mode === "differs" && (
        <p class="comparison-marks">
          <DifferenceMarks />
          <span class="faint">
            {unequal_cells(left.viewer.info, right.viewer.info) ? "What lies within a cell of the coarser grid is the same." : "Compared cell by cell."} Through a veil of{" "}
            {left.viewer.info.id}.
          </span>
        </p>
      )}
    </section>
  );
}
