// Below each view: play, a slider, and the slice as a number of cells and as a coordinate.
import { useSignal } from "@preact/signals";
import { AXIS_NAMES, type AxisIndex } from "../api";
import { width_at } from "../dock/runs";
import { decimals } from "../format";
import type { Viewer } from "../viewer";
import { toggle_sweep } from "./actions";

// A box for a number: what is typed counts on Enter or when the box is left; nonsense goes back to what it was.
function NumberBox({ text, label, width, suffix, take }: { text: string; label: string; width: number; suffix?: string; take: (n: number) => void }) {
  const typed = useSignal<string | null>(null);
  const finish = () => {
    const n = Number(typed.value?.trim().replace(",", ".").replace("−", "-"));
    if (typed.value !== null && typed.value.trim() !== "" && Number.isFinite(n)) take(n);
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
        value={typed.value ?? text}
        onInput={(e) => (typed.value = e.currentTarget.value)}
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

export function SliceBar({ viewer, axis }: { viewer: Viewer; axis: AxisIndex }) {
  const name = AXIS_NAMES[axis];
  const slice = viewer.slice[axis].value;
  const a = viewer.axes[axis];
  const playing = viewer.sweeping.value === axis;
  const take = (index: number) => {
    viewer.sweeping.value = null;
    viewer.set_slice(axis, index);
  };
  const coordinate = (i: number) => a.centre(i).toFixed(decimals(width_at(a, i)));
  const widest = Math.max(coordinate(0).length, coordinate(a.cells - 1).length, coordinate(slice).length);
  return (
    <div class="slice-bar">
      <button class="slice-play" aria-label={playing ? `Pause ${name}` : `Play the slices across ${name}`} aria-pressed={playing} title={playing ? "Pause (p)" : "Play (p)"} onClick={() => toggle_sweep(viewer, axis)}>
        <svg viewBox="0 0 16 16" width="14" height="14" aria-hidden="true">
          <path d={playing ? "M4 3h3v10H4zM9 3h3v10H9z" : "M4 2.5v11l9-5.5z"} fill="currentColor" />
        </svg>
      </button>
      <input type="range" aria-label={`Slice across ${name}`} min={0} max={a.cells - 1} step={1} value={slice} onInput={(e) => take(e.currentTarget.valueAsNumber)} disabled={a.cells === 1} />
      <NumberBox label={`Slice across ${name}, from 0 to ${a.cells - 1}`} text={String(slice)} width={String(a.cells - 1).length} take={take} />
      <NumberBox
        label={`Coordinate ${name} of the slice's cells, in ${viewer.units}`}
        text={coordinate(slice)}
        width={widest}
        suffix={viewer.units}
        take={(x) => take(a.cell_at(x))}
      />
    </div>
  );
}
