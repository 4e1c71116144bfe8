// What is compared with what, and how.
import type { Signal } from "@preact/signals";
import { AXES, AXIS_NAMES, type AxisIndex, type GridSummary } from "../base/grid";
import { change_comparison, end_comparison, new_comparison } from "../state/comparison";
import type { Comparison, ComparisonMode, Viewer } from "../state/viewer";
import { Icon } from "../widgets/icons";
import { type Segment, Segmented } from "../widgets/segmented";
import { Select } from "../widgets/select";

const MODES: readonly Segment<ComparisonMode>[] = [
  { value: "side", text: "Side by side", title: "Two views with one camera" },
  { value: "wipe", text: "Wipe", title: "One on the other, up to a handle" },
  { value: "differs", text: "What differs", title: "What was added and removed, and what has another material" },
];
const IN_SPACE = 3;
const ACROSS: readonly Segment<AxisIndex | typeof IN_SPACE>[] = [
  ...AXES.map((axis) => {
    const [name, label] = [AXIS_NAMES[axis], `Slices across ${AXIS_NAMES[axis]}`];
    return { value: axis, text: name, class: `layout-${name}`, title: label, "aria-label": label };
  }),
  { value: IN_SPACE, text: "3D", class: "layout-3d", title: "3D: both grids with one camera", "aria-label": "3D: both grids with one camera" },
];

export function ComparisonBar({ viewer, comparison, grids }: { viewer: Viewer; comparison: Signal<Comparison>; grids: readonly GridSummary[] }) {
  const now = comparison.value;
  const own = viewer.info.id;
  const ids = [...new Set([...grids.map(({ id }) => id), own, now.other])];
  const choices = ids.map((id) => ({ value: id, label: id === own ? `${id} (another slice)` : id }));
  const change = (what: Partial<Comparison>) => change_comparison(viewer, { ...now, ...what });
  const begin_anew = (other: string, axis: Comparison["axis"]) => {
    const { together, apart } = new_comparison(viewer, other, axis);
    change({ other, axis, together, apart, space: now.space && axis === now.axis });
  };
  return (
    <section class="comparison-bar" aria-label="Comparison">
      <label class="comparison-other">
        <b>{own}</b> with
        <Select class="" label="Compare with" value={now.other} list={choices} set={(other) => begin_anew(other, now.axis)} />
      </label>
      <Segmented
        class="comparison-axes"
        label="Slices across an axis, or three dimensions"
        value={now.space ? IN_SPACE : now.axis}
        list={ACROSS}
        set={(axis) => {
          if (axis === IN_SPACE || axis === now.axis) change({ space: axis === IN_SPACE });
          else begin_anew(now.other, axis);
        }}
      />
      <Segmented label="How they are compared" value={now.mode} list={MODES} set={(mode) => change({ mode })} />
      <label class="comparison-together" hidden={now.space} title="Whether moving one slice moves the other one as well">
        <input type="checkbox" checked={now.together} onChange={(e) => change({ together: e.currentTarget.checked })} />
        <span>Move</span> together
      </label>
      <span class="spacer" />
      <button class="button comparison-end" aria-label="End the comparison" onClick={() => end_comparison(viewer)}>
        <Icon name="close" />
        <span>End</span>
      </button>
    </section>
  );
}
