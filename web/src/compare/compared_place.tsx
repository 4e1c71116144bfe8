// The materials in both grids at the pointer or, without one, at the crosshair; and how exact the marks of differences are.
import type { Signal } from "@preact/signals";
import { FRAMES } from "../base/axis";
import { coordinate, grouped } from "../base/format";
import { AXES, AXIS_NAMES, type AxisIndex } from "../base/grid";
import { LabelNames } from "../dock/label_names";
import { type Totals, slices_meet } from "../state/comparison";
import type { Comparison } from "../state/viewer";
import type { Stage } from "../views/stage";
import type { Pair } from "./pair";

// The labels at a point of the slice that a stage shows: null outside the grid, or while they are not known.
function labels_at({ viewer, views, store, sets }: Stage, axis: AxisIndex, point: readonly [number, number, number]): readonly number[] | null {
  const { u, v } = FRAMES[axis];
  const [a, b] = [viewer.axes[u].cell_at(point[u]), viewer.axes[v].cell_at(point[v])];
  if (a < 0 || b < 0 || a >= viewer.cells[u] || b >= viewer.cells[v]) return null;
  const finest = views[axis].finest_at(store, viewer.slice[axis].value, a, b, viewer.info.levels.length);
  return finest && sets.members(finest.set);
}

// Added is what only the grid on the right has. `totals`: how many cells of each.
export function DifferenceMarks({ totals }: { totals?: Totals }) {
  const mark = (kind: keyof Totals, words: string) => (
    <span>
      <span class={`mark-of ${kind}`} /> {words} {totals && <b>{grouped(totals[kind])}</b>}
    </span>
  );
  return (
    <>
      {mark("added", "added")}
      {mark("removed", "removed")}
      {mark("differs", "other material")}
    </>
  );
}

function Marks({ pair, axis, meet }: { pair: Pair; axis: AxisIndex; meet: boolean }) {
  // The coarsest level in sight: graded grids show several.
  const level = ({ views }: Stage) => Math.max(0, ...views[axis].places.map((place) => place.level));
  const [a, b] = [level(pair.left), level(pair.right)];
  const exact = a === 0 && b === 0;
  const farther = AXES.some((d) => {
    const { bounds } = pair.left.viewer;
    return [pair.left, pair.right].some(({ viewer }) => viewer.axes[d].min > bounds[d].min || viewer.axes[d].max < bounds[d].max);
  });
  const any = (of: "waiting" | "damaged") => pair.left[of][axis].value || pair.right[of][axis].value;
  let words = `Compared at ${a === b ? `level ${a}` : `levels ${a} and ${b}`}, by all materials in each coarse cell. Zoom in for single cells.`;
  if (!meet) words = "Nothing is marked, because the slices lie at different places.";
  else if (any("waiting")) words = "Loading …";
  else if (any("damaged")) words = "Nothing is marked where a file can't be read.";
  else if (exact) words = "Compared cell by cell (level 0): exact for what is in sight.";
  return (
    <p class="comparison-marks">
      <DifferenceMarks />
      {!exact && (
        <span title="The cells of a coarse level are known by all materials in them. Here the two have some in common, and others not.">
          <span class="mark-of partly" /> differs in part
        </span>
      )}
      {farther && (
        <span>
          <span class="mark-of alone" /> in one grid only
        </span>
      )}
      <span class="faint" role="status">
        {words}
      </span>
    </p>
  );
}

export function ComparedPlace({ pair, comparison }: { pair: Pair; comparison: Signal<Comparison> }) {
  const { axis, mode } = comparison.value;
  const { left, right } = pair;
  pair.frames.value; // tiles that have come may tell more
  const hover = left.viewer.hover.value ?? right.viewer.hover.value;
  const point = hover?.point ?? left.viewer.centre_of(left.viewer.cell.value);
  const meet = slices_meet(left.viewer, right.viewer, comparison.value);
  const side = (stage: Stage) => {
    const { viewer } = stage;
    const along = viewer.axes[axis];
    const slice = viewer.slice[axis].value;
    return (
      <div class="compared-side">
        <b>{viewer.info.id}</b>
        <span class="faint">
          {AXIS_NAMES[axis]} = {coordinate(along.centre(slice), along.width(slice))}
        </span>
        <LabelNames viewer={viewer} labels={labels_at(stage, axis, point)} />
      </div>
    );
  };
  return (
    <section class="compared" aria-label="Read-out">
      <div class="compared-place">
        <span class="faint">{hover ? "Pointer" : "Crosshair"}</span>
        {AXES.filter((d) => d !== axis).map((d) => (
          <span key={d}>
            {AXIS_NAMES[d]} = {coordinate(point[d], left.viewer.axes[d].finest)} {left.viewer.units}
          </span>
        ))}
        {side(left)}
        {side(right)}
        {!meet && <span role="status">One grid ends here: its nearest slice is shown.</span>}
      </div>
      {mode === "differs" && <Marks pair={pair} axis={axis} meet={meet} />}
    </section>
  );
}
