// Pointer and wheel on the overview's canvas, and its keys. A left drag orbits. A right or middle drag, or one with shift,
// pans. The wheel and pinching move towards what is under the pointer, a click selects it or measures from it, and a double
// click goes there. The arrow keys orbit, + and - move, and Home shows everything.
import { type Orbit, panned, turned } from "./space/camera";

// The overview, as far as gestures know it.
interface GestureTarget {
  readonly viewpoint: { readonly orbit: Orbit };
  readonly hover: { hide(): void };
  move(to: Orbit): void; // and draws it soon
  dolly(factor: number, x?: number, y?: number): void; // towards what is seen there, or else towards the middle
  fly_home(): void;
  click(x: number, y: number, shift: boolean): void;
  go_to(x: number, y: number): Promise<void>;
  name_what_is_at(x: number, y: number): void; // with no button pressed
}

const TURN = 0.4; // degrees per pixel
const STILL = 4; // pixels that a click may move
const TURNED = 5; // degrees per key
const CLOSER = 1.15;

// What keys do here. Which of the views they are for is the matter of those who know all views.
export function keys_of(overview: GestureTarget): Record<string, () => void> {
  const turn = (azimuth: number, elevation: number) => () => overview.move(turned(overview.viewpoint.orbit, azimuth, elevation));
  const closer = () => overview.dolly(1 / CLOSER);
  return {
    ArrowLeft: turn(-TURNED, 0),
    ArrowRight: turn(TURNED, 0),
    ArrowUp: turn(0, TURNED),
    ArrowDown: turn(0, -TURNED),
    "+": closer,
    "=": closer,
    "-": () => overview.dolly(CLOSER),
    Home: () => overview.fly_home(),
  };
}

export function listen_gestures(canvas: HTMLCanvasElement, overview: GestureTarget): () => void {
  const stop = new AbortController();
  const on = <K extends keyof HTMLElementEventMap>(type: K, call: (event: HTMLElementEventMap[K]) => void, options: AddEventListenerOptions = {}) =>
    canvas.addEventListener(type, call, { ...options, signal: stop.signal });
  const pointers = new Map<number, { x: number; y: number }>();
  let panning = false;
  let moved = 0; // pixels since the button was pressed

  const pan = (dx: number, dy: number) => {
    const { width, height } = canvas.getBoundingClientRect();
    overview.move(panned(overview.viewpoint.orbit, -dx / height, dy / height, width / height));
  };
  const place = (event: MouseEvent): [number, number] => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  on("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    panning = event.button !== 0 || event.shiftKey;
    moved = pointers.size > 1 || event.button !== 0 ? Infinity : 0;
    overview.hover.hide();
    event.preventDefault();
  });
  on("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) {
      if (event.pointerType !== "touch") overview.name_what_is_at(...place(event));
      return;
    }
    const now = { x: event.clientX, y: event.clientY };
    const [dx, dy] = [now.x - before.x, now.y - before.y];
    if (moved + Math.hypot(dx, dy) <= STILL) return;
    moved += Math.hypot(dx, dy);
    pointers.set(event.pointerId, now);
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)![1];
      const apart = (p: { x: number; y: number }) => Math.max(Math.hypot(p.x - other.x, p.y - other.y), 1);
      const box = canvas.getBoundingClientRect();
      overview.dolly(apart(before) / apart(now), (now.x + other.x) / 2 - box.left, (now.y + other.y) / 2 - box.top);
      pan(dx / 2, dy / 2);
    } else if (panning) pan(dx, dy);
    else overview.move(turned(overview.viewpoint.orbit, -dx * TURN, dy * TURN));
  });
  on("pointerup", (event) => {
    if (pointers.delete(event.pointerId) && moved <= STILL) overview.click(...place(event), event.shiftKey);
  });
  on("pointercancel", (event) => pointers.delete(event.pointerId));
  on("pointerleave", () => overview.hover.hide());
  on("contextmenu", (event) => event.preventDefault());
  on(
    "wheel",
    (event) => {
      event.preventDefault();
      const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 33 : 1);
      overview.dolly(Math.exp(Math.min(Math.max(pixels, -240), 240) * (event.ctrlKey ? 0.008 : 0.0015)), ...place(event));
    },
    { passive: false },
  );
  on("dblclick", (event) => void overview.go_to(...place(event)));
  return () => stop.abort();
}
