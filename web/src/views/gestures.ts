// Wheel, mouse, pen and fingers on one view. bindings.ts lists what they do.
import { batch } from "@preact/signals";
import { AXIS_NAMES, type AxisIndex, type Index3 } from "../base/grid";
import { say } from "../base/messages";
import { if_allowed } from "../base/storage";
import { measure_thickness, toggle_layout } from "./actions";
import { cursor_of } from "./drawing/box_handles";
import type { Stage } from "./stage";
import { type Drag, handle_under, start_handle, start_tool } from "./tools";
import type { View } from "./view";

const NOTCH = 60; // pixels of scrolling from which on an event is a notch of a wheel, not a trackpad's
const WHEEL = 120; // pixels per notch, when several come in one event
const SWIPE = 24; // pixels of a trackpad per slice
const STILL = 4; // CSS pixels that the pointer may move during a click
const LONG = 500; // milliseconds of a long press

// Once in a browser, as it zooms elsewhere.
function say_what_the_wheel_does(): void {
  const KEY = "teracell-wheel";
  if_allowed(() => {
    if (localStorage.getItem(KEY)) return;
    localStorage.setItem(KEY, "told");
    say("The wheel goes through the slices; with ctrl it zooms.");
  });
}

interface Spot {
  readonly x: number; // CSS pixels of the view
  readonly y: number;
}

export class Gestures {
  private readonly view: View;
  private readonly listening = new AbortController();
  private readonly pointers = new Map<number, Spot>(); // that are down
  private drag: Drag | null = null; // of a tool
  private from: { readonly x: number; readonly y: number; readonly button: number; moved: boolean } | null = null; // where a click or a drag began
  private swiped = 0; // pixels of a trackpad that no slice has been counted for
  private long_press = 0;
  // Where the crosshair and the pin were before the last two presses, the last one first.
  private presses: { cell: Index3; pinned: Index3 | null }[] = [];

  constructor(
    private readonly stage: Stage,
    private readonly axis: AxisIndex,
    private readonly body: HTMLElement,
  ) {
    this.view = stage.views[axis];
    const { signal } = this.listening;
    body.addEventListener("wheel", (event) => this.turn(event), { passive: false, signal });
    body.addEventListener("pointerdown", (event) => this.press(event), { signal });
    body.addEventListener("pointermove", (event) => this.move(event), { signal });
    for (const end of ["pointerup", "pointercancel"] as const) body.addEventListener(end, (event) => this.release(event), { signal });
    body.addEventListener("pointerleave", () => this.leave(), { signal });
    body.addEventListener("contextmenu", (event) => this.open_menu(event), { signal });
    body.addEventListener("dblclick", () => this.double_click(), { signal });
  }

  stop(): void {
    this.listening.abort();
    clearTimeout(this.long_press);
  }

  private spot_of(event: MouseEvent): Spot {
    const box = this.body.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  private cell_at({ x, y }: Spot): Index3 | null {
    const { viewer } = this.stage;
    if (viewer.zoom.value === 0) return null;
    const { cell } = this.view.under(viewer, x, y);
    return viewer.has(cell) ? cell : null;
  }

  private turn(event: WheelEvent): void {
    event.preventDefault();
    if (event.ctrlKey || event.metaKey) {
      const { x, y } = this.spot_of(event);
      const pixels = event.deltaY * (event.deltaMode === 0 ? 1 : 33);
      this.stage.zoom_by(this.axis, Math.exp(-Math.min(Math.max(pixels, -30), 30) / 100), x, y);
      return;
    }
    const steps = this.steps_of(event);
    if (steps === 0) return;
    say_what_the_wheel_does();
    const { viewer } = this.stage;
    viewer.sweeping.value = null;
    const slice = viewer.cell.value[this.axis];
    if (event.altKey) {
      const slab = 2 ** this.view.level;
      viewer.set_slice(this.axis, (Math.floor(slice / slab) + steps) * slab + Math.floor(slab / 2));
    } else viewer.set_slice(this.axis, slice + steps * (event.shiftKey ? 10 : 1));
  }

  // By how many slices an event of the wheel or of a trackpad moves.
  private steps_of(event: WheelEvent): number {
    const delta = event.deltaY || (event.shiftKey ? event.deltaX : 0); // shift turns a wheel sideways
    if (event.deltaMode !== 0 || Math.abs(delta) >= NOTCH) {
      this.swiped = 0;
      return Math.sign(delta) * (event.deltaMode !== 0 ? 1 : Math.max(1, Math.round(Math.abs(delta) / WHEEL)));
    }
    this.swiped += delta;
    const steps = Math.trunc(this.swiped / SWIPE);
    this.swiped -= steps * SWIPE;
    return steps;
  }

  private press(event: PointerEvent): void {
    const { viewer } = this.stage;
    this.body.focus({ preventScroll: true });
    this.body.setPointerCapture(event.pointerId);
    const at = this.spot_of(event);
    this.pointers.set(event.pointerId, at);
    clearTimeout(this.long_press);
    if (this.pointers.size > 1) {
      this.let_go(); // two fingers are not a click
      return;
    }
    this.presses = [{ cell: viewer.cell.value, pinned: viewer.pinned.value }, ...this.presses.slice(0, 1)];
    this.from = { ...at, moved: false, button: event.button };
    this.drag = event.button === 0 ? (start_tool(this.stage, this.axis, at.x, at.y) ?? start_handle(this.stage, this.axis, at.x, at.y)) : null;
    // Not every browser reports a long press as the opening of a context menu.
    if (event.pointerType === "touch" && !this.drag) this.long_press = window.setTimeout(() => this.recentre(at), LONG);
  }

  // Forgets the press that began, so that it becomes neither a click nor a drag.
  private let_go(): void {
    this.drag?.end(false);
    this.drag = null;
    this.from = null;
  }

  private move(event: PointerEvent): void {
    const { stage, view } = this;
    const at = this.spot_of(event);
    if (event.pointerType !== "touch") {
      for (const other of stage.views) other.pointer = null;
      view.pointer = at;
      stage.invalidate();
    }
    const last = this.pointers.get(event.pointerId);
    if (!last) {
      const handle = stage.viewer.tool.value === "look" ? handle_under(stage, this.axis, at.x, at.y) : null;
      this.body.style.cursor = handle ? cursor_of(handle) : "";
      return;
    }
    if (this.pointers.size === 2) this.pinch(event.pointerId, at);
    else {
      this.pointers.set(event.pointerId, at);
      this.pull(last, at, event.altKey);
    }
  }

  private pinch(finger: number, at: Spot): void {
    // The middle between the two fingers, and their distance.
    const fingers = () => {
      const [a, b] = [...this.pointers.values()] as [Spot, Spot];
      return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1) };
    };
    const before = fingers();
    this.pointers.set(finger, at);
    const now = fingers();
    this.stage.zoom_by(this.axis, now.apart / before.apart, before.x, before.y);
    this.stage.pan(this.axis, now.x - before.x, now.y - before.y);
  }

  // Draws with the tool, or moves the picture.
  private pull(last: Spot, at: Spot, free: boolean): void {
    const { from } = this;
    if (!from) return;
    const starts = !from.moved && Math.hypot(at.x - from.x, at.y - from.y) > STILL;
    from.moved ||= starts;
    if (!from.moved || from.button === 2) return;
    clearTimeout(this.long_press);
    if (this.drag) this.drag.move(at.x, at.y, free);
    else {
      this.body.classList.add("dragging");
      const { x, y } = starts ? from : last;
      this.stage.pan(this.axis, at.x - x, at.y - y);
    }
  }

  private release(event: PointerEvent): void {
    if (!this.pointers.delete(event.pointerId)) return;
    clearTimeout(this.long_press);
    this.body.classList.remove("dragging");
    const { from } = this;
    if (!from || this.pointers.size > 0) return;
    const is_up = event.type === "pointerup";
    if (this.drag) this.drag.end(from.moved && is_up);
    else if (!from.moved && from.button === 0 && is_up) this.click(this.spot_of(event), event.shiftKey);
    this.drag = null;
    this.from = null;
  }

  private click(at: Spot, shift: boolean): void {
    const { viewer } = this.stage;
    const cell = this.cell_at(at);
    if (!cell) return;
    if (shift) return measure_thickness(viewer, this.axis, cell);
    const again = viewer.pinned.value?.every((i, d) => i === cell[d]) ?? false;
    viewer.set_cell(cell);
    if (!viewer.compared) viewer.pinned.value = again ? null : cell;
  }

  // The two clicks of a double click leave nothing behind.
  private double_click(): void {
    const { viewer } = this.stage;
    batch(() => {
      const before = this.presses[1];
      if (before) [viewer.cell.value, viewer.pinned.value] = [before.cell, before.pinned];
      toggle_layout(viewer, AXIS_NAMES[this.axis]);
    });
  }

  private recentre(at: Spot): void {
    const cell = this.cell_at(at);
    if (cell) this.stage.viewer.go_to_cell(cell);
    clearTimeout(this.long_press);
    this.let_go(); // a long press is not a tap
  }

  private open_menu(event: MouseEvent): void {
    event.preventDefault();
    if (this.pointers.size === 0 || this.from) this.recentre(this.spot_of(event)); // otherwise the long press was recognised before
  }

  private leave(): void {
    this.view.pointer = null;
    this.stage.invalidate();
  }
}
