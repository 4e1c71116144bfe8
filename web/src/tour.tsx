// The first minute: a card that points at one thing after another, while everything stays usable. Help offers it until it was seen or refused.
import { signal } from "@preact/signals";
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { if_allowed } from "./base/storage";
import type { Viewer } from "./state/viewer";
import { TOUR, type TourStep } from "./tour_steps";
import { IconButton } from "./widgets/icons";

const KEY = "teracell-tour";
const GAP = 10; // pixels between the card and what it points at

// Where nothing can be kept it is not offered, since it would be offered for ever.
export const tour_offered = signal(if_allowed(() => localStorage.getItem(KEY) === null) ?? false);
const step = signal<number | null>(null);

function end_tour(): void {
  step.value = null;
  tour_offered.value = false;
  if_allowed(() => localStorage.setItem(KEY, "seen"));
}

function start_tour(): void {
  end_tour(); // it is not offered again, however it ends
  step.value = 0;
}

function show_target(viewer: Viewer, { view, panel }: TourStep): void {
  if (view && viewer.layout.value !== "four") viewer.layout.value = view;
  if (panel) viewer.panel.value = panel;
}

interface Spot {
  readonly ring: { left: number; top: number; width: number; height: number };
  readonly card: { left: number; top: number };
}

// Below what it points at, above it, or within its lower end.
function spot_of(target: Element, card: HTMLElement): Spot {
  const { left, top, right, bottom, width, height } = target.getBoundingClientRect();
  const [w, h] = [card.offsetWidth, card.offsetHeight];
  const y = bottom + GAP + h < innerHeight ? bottom + GAP : top - GAP - h > 0 ? top - GAP - h : bottom - GAP - h;
  const inside = (at: number, size: number, most: number) => Math.max(GAP, Math.min(at, most - size - GAP));
  return { ring: { left, top, width, height }, card: { left: inside((left + right - w) / 2, w, innerWidth), top: inside(y, h, innerHeight) } };
}

export function Tour({ viewer }: { viewer: Viewer }) {
  const n = step.value;
  const card = useRef<HTMLDivElement>(null);
  const [spot, set_spot] = useState<Spot | null>(null);
  const now = n === null || viewer.compare.value ? undefined : TOUR[n];
  const layout = viewer.layout.value;
  const panel = viewer.panel.value;
  useLayoutEffect(() => void (now && show_target(viewer, now)), [now]);
  useLayoutEffect(() => {
    if (!now) return;
    const place = () => {
      const target = document.querySelector(now.at);
      set_spot(target && card.current ? spot_of(target, card.current) : null);
    };
    const soon = requestAnimationFrame(place); // once the layout is the one that was asked for
    addEventListener("resize", place);
    return () => {
      cancelAnimationFrame(soon);
      removeEventListener("resize", place);
    };
  }, [now, layout, panel]);
  useEffect(() => {
    if (n !== null) card.current?.querySelector<HTMLElement>(".primary")!.focus();
  }, [n]);
  if (!now || n === null) return null;
  const last = n + 1 === TOUR.length;
  const to = (next: number) => (step.value = next);
  return (
    <>
      {spot && <div class="tour-ring" style={spot.ring} aria-hidden="true" />}
      <div
        ref={card}
        class="tour"
        role="dialog"
        aria-labelledby="tour-head"
        aria-describedby="tour-text"
        style={spot?.card ?? { opacity: 0 }}
        onKeyDown={(event) => {
          if (event.key === "Escape") end_tour();
          else if (event.key === "ArrowLeft" && n > 0) to(n - 1);
          else if (event.key === "ArrowRight" && !last) to(n + 1);
          else return;
          event.preventDefault();
          event.stopPropagation();
        }}
      >
        <div class="tour-title">
          <h2 id="tour-head">{now.head}</h2>
          <span class="faint">
            {n + 1} of {TOUR.length}
          </span>
          <IconButton icon="close" label="Skip the rest" onClick={end_tour} />
        </div>
        <p id="tour-text">{now.text}</p>
        <div class="tour-buttons">
          {n > 0 && (
            <button class="button" onClick={() => to(n - 1)}>
              Back
            </button>
          )}
          <button class="button primary" onClick={() => (last ? end_tour() : to(n + 1))}>
            {last ? "Done" : "Next"}
          </button>
        </div>
      </div>
    </>
  );
}

// Stands at the top of the help.
export function TourOffer({ close }: { close: () => void }) {
  if (!tour_offered.value) return null;
  // It begins once the dialog is gone: while that is open, nothing else can have the focus.
  const take = () => {
    addEventListener("close", start_tour, { capture: true, once: true });
    close();
  };
  return (
    <div class="tour-offer">
      <p>New here? A first minute shows six things on this grid.</p>
      <div class="toolbar">
        <button class="button primary" onClick={take}>
          Show me
        </button>
        <button class="button" onClick={end_tour}>
          No, thanks
        </button>
      </div>
    </div>
  );
}
