// The handle up to which the picture on the left is seen, over the one on the right. It is dragged, or moved by keys.
import type { Signal } from "@preact/signals";
import { useRef } from "preact/hooks";
import { slid_by_key } from "../base/slider";
import type { Comparison } from "../state/viewer";

const STEP = 0.01;

export function WipeHandle({ comparison }: { comparison: Signal<Comparison> }) {
  const handle = useRef<HTMLDivElement>(null);
  const { wipe } = comparison.value;
  const move = (to: number) => (comparison.value = { ...comparison.value, wipe: Math.min(Math.max(to, 0), 1) });
  const drag = (event: PointerEvent) => {
    if (!handle.current!.hasPointerCapture(event.pointerId)) return;
    const { left, width } = handle.current!.parentElement!.getBoundingClientRect();
    move((event.clientX - left) / width);
  };
  return (
    <div
      ref={handle}
      class="wipe-handle"
      role="slider"
      tabIndex={0}
      aria-label="How far the picture on the left is seen"
      aria-orientation="horizontal"
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={Math.round(100 * wipe)}
      aria-valuetext={`${Math.round(100 * wipe)} %`}
      title="Drag, or press ← and →"
      onPointerDown={(event) => {
        event.preventDefault(); // no selection
        handle.current!.focus();
        handle.current!.setPointerCapture(event.pointerId);
      }}
      onPointerMove={drag}
      onKeyDown={(event) => {
        const to = slid_by_key(event.key, wipe, 0, 1, STEP);
        if (to === null) return;
        event.preventDefault();
        move(to);
      }}
    >
      <span class="wipe-grip" aria-hidden="true">
        <svg viewBox="0 0 16 16" width="16" height="16" fill="none" stroke="currentColor" stroke-width="1.8">
          <path d="M6 4L2.5 8 6 12M10 4l3.5 4L10 12" />
        </svg>
      </span>
    </div>
  );
}
