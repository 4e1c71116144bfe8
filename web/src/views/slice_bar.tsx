// The bar below each view: play, one slice back or forth, a slider, and the slice as a number and as a coordinate.
import { useSignal } from "@preact/signals";
import { coordinate, number_of } from "../base/format";
import { AXIS_NAMES, type AxisIndex } from "../base/grid";
import { outside_coordinate, outside_slice, say_of_place } from "../state/outside";
import type { Viewer } from "../state/viewer";
import { toggle_sweep } from "./actions";

interface NumberBoxProps {
  text: string;
  label: string;
  width: number;
  suffix?: string;
  whole?: boolean;
  take: (n: number) => void;
}

// A field for a number. What is typed takes effect on Enter, or when the field is left. If it is not a number, the field
// flashes and shows the earlier one again.
export function NumberBox({ text, label, width, suffix, whole = false, take }: NumberBoxProps) {
  const typed = useSignal<string | null>(null);
  const refused = useSignal(false);
  const finish = () => {
    if (typed.value === null) return;
    const n = number_of(typed.value, whole);
    if (n === null) refused.value = true;
    else take(n);
    typed.value = null;
  };
  return (
    <label class="slice-number">
      <input
        type="text"
        inputMode="decimal"
        aria-label={label}
        title={label}
        style={{ width: `${width + 1}ch` }}
        aria-invalid={refused.value}
        value={typed.value ?? text}
        onInput={(e) => {
          typed.value = e.currentTarget.value;
          refused.value = false;
        }}
        onAnimationEnd={() => (refused.value = false)}
        onFocus={(e) => e.currentTarget.select()}
        onBlur={finish}
        onKeyDown={(e) => {
          if (e.key === "Enter") finish();
          else if (e.key === "Escape") typed.value = null;
        }}
      />
      {suffix && <span>{suffix}</span>}
    </label>
  );
}

function Step({ axis, by, take, disabled }: { axis: AxisIndex; by: 1 | -1; take: () => void; disabled: boolean }) {
  const what = `${by > 0 ? "Next" : "Previous"} slice`;
  return (
    <button
      class="slice-button slice-step"
      tabIndex={-1} // the slider beside it takes the arrow keys
      aria-label={`${what} across ${AXIS_NAMES[axis]}`}
      title={`${what} (${by > 0 ? "." : ","})`}
      onClick={take}
      disabled={disabled}
    >
      <svg viewBox="0 0 16 16" width="14" height="14" aria-hidden="true" fill="none" stroke="currentColor" stroke-width="1.8">
        <path d={by > 0 ? "M6 3.5 10.5 8 6 12.5" : "M10 3.5 5.5 8l4.5 4.5"} />
      </svg>
    </button>
  );
}

export function SliceBar({ viewer, axis }: { viewer: Viewer; axis: AxisIndex }) {
  const name = AXIS_NAMES[axis];
  const slice = viewer.slice[axis].value;
  const a = viewer.axes[axis];
  const playing = viewer.sweeping.value === axis;
  const take = (index: number) => {
    viewer.sweeping.value = null;
    viewer.set_slice(axis, index);
  };
  // What is typed may lie outside; buttons and the slider do not.
  const take_typed = (index: number, outside: string | null) => {
    take(index);
    if (outside) say_of_place(viewer, outside);
  };
  const place = (i: number) => coordinate(a.centre(i), a.width(i));
  const widest = Math.max(place(0).length, place(a.cells - 1).length, place(slice).length);
  return (
    <div class="slice-bar">
      <button
        class="slice-button slice-play"
        aria-label={playing ? `Pause ${name}` : `Play the slices across ${name}`}
        aria-pressed={playing}
        title={playing ? "Pause (p)" : "Play (p)"}
        onClick={() => toggle_sweep(viewer, axis)}
      >
        <svg viewBox="0 0 16 16" width="14" height="14" aria-hidden="true">
          <path d={playing ? "M4 3h3v10H4zM9 3h3v10H9z" : "M4 2.5v11l9-5.5z"} fill="currentColor" />
        </svg>
      </button>
      <Step axis={axis} by={-1} take={() => take(slice - 1)} disabled={slice === 0} />
      <input
        type="range"
        aria-label={`Slice across ${name}`}
        min={0}
        max={a.cells - 1}
        step={1}
        value={slice}
        onInput={(e) => take(e.currentTarget.valueAsNumber)}
        disabled={a.cells === 1}
      />
      <Step axis={axis} by={1} take={() => take(slice + 1)} disabled={slice === a.cells - 1} />
      <NumberBox label={`Slice across ${name}, from 0 to ${a.cells - 1}`} text={String(slice)} width={String(a.cells - 1).length} take={(i) => take_typed(i, outside_slice(viewer.axes, axis, i))} whole />
      <NumberBox
        label={`Coordinate ${name} of the slice's cells, in ${viewer.units}`}
        text={place(slice)}
        width={widest}
        suffix={viewer.units}
        take={(x) => take_typed(a.cell_at(x), outside_coordinate(viewer.axes, axis, x, viewer.units))}
      />
    </div>
  );
}
