// Pointer, wheel and keys on the overview's canvas. A left drag orbits. A right or middle drag, or one with shift,
// pans. The wheel and pinching dolly, and a double click picks. The arrow keys orbit, + and - dolly, and Home shows
// everything.
import { type Orbit, dollied, panned, turned } from "./camera";

export interface GestureTarget {
  orbit(): Orbit;
  move(to: Orbit): void; // and draws it soon
  home(): void;
  pick(x: number, y: number): void;
}

const TURN = 0.4; // degrees per pixel
const KEYS: Record<string, readonly [number, number]> = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5] };

export function listen_gestures(canvas: HTMLCanvasElement, target: GestureTarget): () => void {
  const stop = new AbortController();
  const on = <K extends keyof HTMLElementEventMap>(type: K, call: (event: HTMLElementEventMap[K]) => void, options: AddEventListenerOptions = {}) =>
    canvas.addEventListener(type, call, { ...options, signal: stop.signal });
  const pointers = new Map<number, { x: number; y: number }>();
  let panning = false;

  const pan = (dx: number, dy: number) => {
    const { width, height } = canvas.getBoundingClientRect();
    target.move(panned(target.orbit(), -dx / height, dy / height, width / height));
  };
  on("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    panning = event.button !== 0 || event.shiftKey;
    event.preventDefault();
  });
  on("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = { x: event.clientX, y: event.clientY };
    const [dx, dy] = [now.x - before.x, now.y - before.y];
    pointers.set(event.pointerId, now);
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)![1];
      const apart = (p: { x: number; y: number }) => Math.max(Math.hypot(p.x - other.x, p.y - other.y), 1);
      target.move(dollied(target.orbit(), apart(before) / apart(now)));
      pan(dx / 2, dy / 2);
    } else if (panning) pan(dx, dy);
    else target.move(turned(target.orbit(), -dx * TURN, dy * TURN));
  });
  for (const type of ["pointerup", "pointercancel"] as const) on(type, (event) => pointers.delete(event.pointerId));
  on("contextmenu", (event) => event.preventDefault());
  on(
    "wheel",
    (event) => {
      event.preventDefault();
      const pixels = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 33 : 1);
      target.move(dollied(target.orbit(), Math.exp(Math.min(Math.max(pixels, -240), 240) * (event.ctrlKey ? 0.008 : 0.0015))));
    },
    { passive: false },
  );
  on("dblclick", (event) => {
    const box = canvas.getBoundingClientRect();
    target.pick(event.clientX - box.left, event.clientY - box.top);
  });
  on("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const turn = KEYS[event.key];
    if (turn) target.move(turned(target.orbit(), turn[0], turn[1]));
    else if (event.key === "+" || event.key === "=") target.move(dollied(target.orbit(), 1 / 1.15));
    else if (event.key === "-") target.move(dollied(target.orbit(), 1.15));
    else if (event.key === "Home") target.home();
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  return () => stop.abort();
}
