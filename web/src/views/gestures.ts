// Wheel, mouse, pen and fingers on one view; what they do stands in bindings.ts.
import { batch } from "@preact/signals";
import { FRAMES } from "../base/axis";
import { AXIS_NAMES, type AxisIndex, type Index3 } from "../base/grid";
import { toggle_layout } from "./actions";
import type { Stage } from "./stage";
import { type Drag, start_tool } from "./tools";

const NOTCH = 60; // pixels of scrolling from which on an event is a notch of a wheel, not a trackpad's
const WHEEL = 120; // pixels a notch, when several come in one event
const SWIPE = 24; // pixels of a trackpad a slice
const STILL = 4; // CSS pixels that a click may move
const LONG = 500; // milliseconds of a long press

export function attach_gestures(stage: Stage, axis: AxisIndex, body: HTMLElement): () => void {
  const { viewer } = stage;
  const view = stage.views[axis];
  const pointers = new Map<number, { x: number; y: number }>();
  let drag: Drag | null = null;
  let from: { x: number; y: number; moved: boolean; button: number } | null = null;
  let swiped = 0;
  let long_press = 0;
  // Where the crosshair and the pin were before the last presses, the last one first.
  let presses: { cell: Index3; pinned: Index3 | null }[] = [];

  const place = (event: MouseEvent) => {
    const box = body.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  const cell_at = ({ x, y }: { x: number; y: number }): Index3 | null => {
    if (viewer.zoom.value === 0) return null;
    const camera = view.camera_of(viewer, 1);
    const { u, v } = FRAMES[axis];
    const cell: Index3 = [...viewer.cell.value];
    cell[u] = camera.across.cell_at(camera.u_at(x));
    cell[v] = camera.up.cell_at(camera.v_at(y));
    return cell.every((i, d) => i >= 0 && i < viewer.cells[d]!) ? cell : null;
  };
  // Where the two fingers are: their middle and distance.
  const fingers = () => {
    const [a, b] = [...pointers.values()] as [{ x: number; y: number }, { x: number; y: number }];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1) };
  };

  const steps_of = (event: WheelEvent): number => {
    const delta = event.deltaY || (event.shiftKey ? event.deltaX : 0); // shift turns a wheel sideways
    if (event.deltaMode !== 0 || Math.abs(delta) >= NOTCH) {
      swiped = 0;
      return Math.sign(delta) * (event.deltaMode !== 0 ? 1 : Math.max(1, Math.round(Math.abs(delta) / WHEEL)));
    }
    swiped += delta;
    const steps = Math.trunc(swiped / SWIPE);
    swiped -= steps * SWIPE;
    return steps;
  };

  const on_wheel = (event: WheelEvent) => {
    event.preventDefault();
    if (event.ctrlKey || event.metaKey) {
      const { x, y } = place(event);
      const pixels = event.deltaY * (event.deltaMode === 0 ? 1 : 33);
      stage.zoom_by(axis, Math.exp(-Math.min(Math.max(pixels, -30), 30) / 100), x, y);
      return;
    }
    const steps = steps_of(event);
    if (steps === 0) return;
    viewer.sweeping.value = null;
    if (event.altKey) {
      const slab = 2 ** view.level;
      viewer.set_slice(axis, (Math.floor(viewer.cell.value[axis] / slab) + steps) * slab + Math.floor(slab / 2));
    } else viewer.set_slice(axis, viewer.cell.value[axis] + steps * (event.shiftKey ? 10 : 1));
  };

  const on_down = (event: PointerEvent) => {
    body.focus({ preventScroll: true });
    body.setPointerCapture(event.pointerId);
    const at = place(event);
    pointers.set(event.pointerId, at);
    clearTimeout(long_press);
    if (pointers.size === 1) {
      presses = [{ cell: viewer.cell.value, pinned: viewer.pinned.value }, ...presses.slice(0, 1)];
      from = { ...at, moved: false, button: event.button };
      drag = event.button === 0 ? start_tool(stage, axis, at.x, at.y) : null;
      // Not every browser makes a context menu's event of it.
      if (event.pointerType === "touch" && !drag) long_press = window.setTimeout(() => recentre(at), LONG);
    } else {
      from = null; // two fingers: no click comes of it
      drag?.end(false);
      drag = null;
    }
  };

  const on_move = (event: PointerEvent) => {
    const at = place(event);
    if (event.pointerType !== "touch") {
      for (const other of stage.views) other.pointer = null;
      view.pointer = at;
      stage.invalidate();
    }
    const last = pointers.get(event.pointerId);
    if (!last) return;
    if (pointers.size === 2) {
      const before = fingers();
      pointers.set(event.pointerId, at);
      const now = fingers();
      stage.zoom_by(axis, now.apart / before.apart, before.x, before.y);
      stage.pan(axis, now.x - before.x, now.y - before.y);
      return;
    }
    pointers.set(event.pointerId, at);
    if (!from) return;
    const starts = !from.moved && Math.hypot(at.x - from.x, at.y - from.y) > STILL;
    from.moved ||= starts;
    if (!from.moved || from.button === 2) return;
    clearTimeout(long_press);
    if (drag) drag.move(at.x, at.y);
    else {
      body.classList.add("dragging");
      stage.pan(axis, starts ? at.x - from.x : at.x - last.x, starts ? at.y - from.y : at.y - last.y);
    }
  };

  const on_up = (event: PointerEvent) => {
    if (!pointers.delete(event.pointerId)) return;
    clearTimeout(long_press);
    body.classList.remove("dragging");
    if (!from || pointers.size > 0) return;
    const ends = event.type === "pointerup";
    if (drag) drag.end(from.moved && ends);
    else if (!from.moved && from.button === 0 && ends) click(place(event));
    drag = null;
    from = null;
  };

  const click = (at: { x: number; y: number }) => {
    const cell = cell_at(at);
    if (!cell) return;
    const again = viewer.pinned.value?.every((i, d) => i === cell[d]) ?? false;
    viewer.set_cell(cell);
    viewer.pinned.value = again ? null : cell;
  };

  // Two clicks that are a double click leave nothing behind.
  const on_double_click = () =>
    batch(() => {
      const before = presses[1];
      if (before) [viewer.cell.value, viewer.pinned.value] = [before.cell, before.pinned];
      toggle_layout(viewer, AXIS_NAMES[axis]);
    });

  const recentre = (at: { x: number; y: number }) => {
    const cell = cell_at(at);
    if (cell) viewer.go_to_cell(cell);
    clearTimeout(long_press);
    drag?.end(false);
    drag = null;
    from = null; // a long press is no tap
  };

  const on_menu = (event: MouseEvent) => {
    event.preventDefault();
    if (pointers.size === 0 || from) recentre(place(event)); // else the long press was seen before
  };

  const on_leave = () => {
    view.pointer = null;
    stage.invalidate();
  };

  const stop = new AbortController();
  const { signal } = stop;
  body.addEventListener("wheel", on_wheel, { passive: false, signal });
  body.addEventListener("pointerdown", on_down, { signal });
  body.addEventListener("pointermove", on_move, { signal });
  for (const end of ["pointerup", "pointercancel"] as const) body.addEventListener(end, on_up, { signal });
  body.addEventListener("pointerleave", on_leave, { signal });
  body.addEventListener("contextmenu", on_menu, { signal });
  body.addEventListener("dblclick", on_double_click, { signal });
  signal.addEventListener("abort", () => clearTimeout(long_press));
  return () => stop.abort();
}
