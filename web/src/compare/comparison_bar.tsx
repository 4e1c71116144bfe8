// What is compared with what, and how.
import type { Signal } from "@preact/signals";
import { AXES, AXIS_NAMES, type GridSummary } from "../base/grid";
import { new_comparison } from "../state/comparison";
import type { Comparison, ComparisonMode, Viewer } from "../state/viewer";
import { Icon } from "../widgets/icons";
import { type Segment, Segmented } from "../widgets/segmented";
import { Select } from "../widgets/select";

const MODES: readonly Segment<ComparisonMode>[] = [
  { value: "side", text: "Side by side", title: "Two slices with one camera" },
  { value: "wipe", text: "Wipe", title: "One slice on the other, up to a handle" },
  { value: "differs", text: "What differs", title: "Marks the cells whose materials have other names" },
];
const ACROSS = AXES.map((axis) => {
  const [name, label] = [AXIS_NAMES[axis], `Slices across ${AXIS_NAMES[axis]}`];
  return { value: axis, text: name, class: `layout-${name}`, title: label, "aria-label": label };
});

export function ComparisonBar({ viewer, comparison, grids }: { viewer: Viewer; comparison: Signal<Comparison>; grids: readonly GridSummary[] }) {
  const now = comparison.value;
  const own = viewer.info.id;
  const ids = [...new Set([...grids.map(({ id }) => id), own, now.other])];
  const choices = ids.map((id) => ({ value: id, label: id === own ? `${id} (another slice)` : id }));
  const change = (what: Partial<Comparison>) => (comparison.value = { ...now, ...what });
  const begin_anew = (other: string, axis: Comparison["axis"]) => {
    const { together, apart } = new_comparison(viewer, other, axis);
    change({ other, axis, together, apart });
  };
  return (
    <section class="comparison-bar" aria-label="Comparison">
      <label class="comparison-other">
        <b>{own}</b> with
        <Select class="" label="Compare with" value={now.other} list={choices} set={(other) => begin_anew(other, now.axis)} />
      </label>
      <Segmented
        class="comparison-axes"
        label="Slices across"
        value={now.axis}
        list={ACROSS}
        set={(axis) => axis !== now.axis && begin_anew(now.other, axis)}
      />
      <Segmented label="How they are compared" value={now.mode} list={MODES} set={(mode) => change({ mode })} />
      <label class="comparison-together" title="Whether moving one slice moves the other one as well">
        <input type="checkbox" checked={now.together} onChange={(e) => change({ together: e.currentTarget.checked })} />
        <span>Move</span> together
      </label>
      <span class="spacer" />
      <button class="button comparison-end" aria-label="End the comparison" onClick={() => (viewer.compare.value = null)}>
        <Icon name="close" />
        <span>End</span>
      </button>
    </section>
  );
}
