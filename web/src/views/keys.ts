// The keys of the views, which bindings.ts lists. They act on the view whose panel has the pointer or the focus.
import type { Signal } from "@preact/signals";
import { choose_tool, escape, fit, mark_measure, measure_thickness, step_crosshair, toggle_layout, toggle_oblique, toggle_sweep } from "./actions";
import type { Stage } from "./stage";

const PAN = 64; // CSS pixels
const ZOOM = 1.25;

const flip = (switched: Signal<boolean>) => (switched.value = !switched.value);

const is_arrow = (key: string) => key.startsWith("Arrow");
// The keys that each type of input uses itself. Types that are not named here hold text and use all keys.
const INPUTS: Record<string, (key: string) => boolean> = {
  range: (key) => key === " " || is_arrow(key),
  radio: (key) => key === " " || key === "Enter" || is_arrow(key),
  checkbox: (key) => key === " " || key === "Enter",
  color: (key) => key === " " || key === "Enter",
};

// Whether the element that has the focus uses the key itself.
function is_taken({ target, key }: KeyboardEvent): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target.closest("dialog, textarea, select, [contenteditable], [role=menu], [role=listbox]")) return true;
  if (target instanceof HTMLInputElement) return INPUTS[target.type]?.(key) ?? true;
  if (key === " " || key === "Enter") return target.closest("button, a, summary, [role=button], [role=tab]") !== null;
  return is_arrow(key) && target.closest("[role=tab], [role=radio]") !== null;
}

// `stage_in_use` is called for each key: of two stages, the one that has the pointer or the focus.
export function attach_keys(stage_in_use: () => Stage): () => void {
  const on_key = (event: KeyboardEvent) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || is_taken(event)) return;
    const action = actions_of(stage_in_use())[is_arrow(event.key) && event.shiftKey ? `Shift+${event.key}` : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  };
  document.addEventListener("keydown", on_key);
  return () => document.removeEventListener("keydown", on_key);
}

function actions_of(stage: Stage): Record<string, () => void> {
  const { viewer } = stage;
  // One cell of the level shown.
  const crosshair = (du: number, dv: number) => step_crosshair(viewer, stage.active, du, dv);
  const step = (by: number) => {
    viewer.sweeping.value = null;
    viewer.set_slice(stage.active, viewer.cell.value[stage.active] + by);
  };
  const zoom = (factor: number) => {
    const view = stage.views[stage.active];
    stage.zoom_by(stage.active, factor, view.width / 2, view.height / 2);
  };
  return {
    ",": () => step(-1),
    ".": () => step(1),
    "<": () => step(-10),
    ">": () => step(10),
    ";": () => step(-10), // shift and ',' on some keyboards
    ":": () => step(10),
    " ": () => toggle_layout(viewer, stage.active_view),
    ArrowLeft: () => stage.pan(stage.active, PAN, 0),
    ArrowRight: () => stage.pan(stage.active, -PAN, 0),
    ArrowUp: () => stage.pan(stage.active, 0, PAN),
    ArrowDown: () => stage.pan(stage.active, 0, -PAN),
    "Shift+ArrowLeft": () => crosshair(-1, 0),
    "Shift+ArrowRight": () => crosshair(1, 0),
    "Shift+ArrowUp": () => crosshair(0, 1),
    "Shift+ArrowDown": () => crosshair(0, -1),
    Enter: () => mark_measure(viewer, stage.active),
    "+": () => zoom(ZOOM),
    "=": () => zoom(ZOOM),
    "-": () => zoom(1 / ZOOM),
    "0": () => fit(viewer),
    a: () => flip(viewer.show_axes),
    b: () => flip(viewer.show_scale),
    l: () => flip(viewer.show_lines),
    e: () => flip(viewer.show_outline),
    o: () => toggle_oblique(viewer, stage.active),
    s: () => viewer.has_shares && flip(viewer.show_shares),
    r: () => flip(viewer.show_leaves),
    p: () => toggle_sweep(viewer, stage.active),
    c: () => viewer.go_to_cell(viewer.cell.value),
    m: () => choose_tool(viewer, "measure"),
    x: () => choose_tool(viewer, "box"),
    t: () => measure_thickness(viewer, stage.active, viewer.cell.value),
    f: () => flip(viewer.figure),
    h: () => flip(viewer.help),
    Escape: () => escape(viewer),
  };
}
