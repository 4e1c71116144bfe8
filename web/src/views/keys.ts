// The keys of the views, which bindings.ts lists. They act on the view under the pointer, or on the one that the keyboard has gone to since
// (pointing.ts).
import type { Signal } from "@preact/signals";
import { ZOOM_STEP } from "../state/zoom";
import { choose_tool, escape, fit, mark_measure, measure_thickness, remove_chosen, show_cells, step_crosshair, toggle_layout, toggle_oblique, toggle_sweep } from "./actions";
import { watch_pointing } from "./pointing";
import type { Stage } from "./stage";

const PAN = 64; // CSS pixels

const flip = (switched: Signal<boolean>) => (switched.value = !switched.value);

const is_arrow = (key: string) => key.startsWith("Arrow");
// The keys that each type of input uses itself. Types that are not named here hold text and use all keys.
const INPUTS: Record<string, (key: string) => boolean> = {
  range: (key) => key === " " || key === "Home" || is_arrow(key),
  radio: (key) => key === " " || key === "Enter" || is_arrow(key),
  checkbox: (key) => key === " " || key === "Enter",
  color: (key) => key === " " || key === "Enter",
};

// Whether all keys are for what has the focus: text is written there, or it lies before the views.
function is_elsewhere(target: Element): boolean {
  if (target.closest("dialog, textarea, [contenteditable], [role=menu], [role=listbox]")) return true;
  return target instanceof HTMLInputElement && !(target.type in INPUTS);
}

// Whether the control that has the focus uses the key itself.
function is_taken(target: Element, key: string): boolean {
  if (target.closest("select")) return true;
  if (target instanceof HTMLInputElement) return INPUTS[target.type]!(key);
  if (key === " " || key === "Enter") return target.closest("button, a, summary, [role=button], [role=tab]") !== null;
  return is_arrow(key) && target.closest("[role=tab], [role=radio]") !== null;
}

// `stage_in_use` is called for each key: of two stages, the one that has the pointer or the focus.
export function attach_keys(stage_in_use: () => Stage): () => void {
  const pointing = watch_pointing();
  // `first`: before the control that has the focus. That is for the view under the pointer, unless the pointer is on the control, or that is
  // the card of the first minute.
  const on_key = (event: KeyboardEvent, first: boolean) => {
    const { target, key } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (target instanceof Element) {
      if (is_elsewhere(target)) return;
      const control_first = !pointing.at_a_view || target.matches(":hover, [role=dialog] *") || key === "Escape";
      if (control_first === first || (control_first && is_taken(target, key))) return;
    } else if (first) return;
    const stage = stage_in_use();
    const name = is_arrow(key) && event.shiftKey ? `Shift+${key}` : key;
    const action = keys_of_its_own(stage)?.[name] ?? actions_of(stage)[name];
    if (!action) return;
    event.preventDefault();
    event.stopPropagation();
    action();
  };
  const listen = (first: boolean) => {
    const listener = (event: KeyboardEvent) => on_key(event, first);
    document.addEventListener("keydown", listener, first);
    return () => document.removeEventListener("keydown", listener, first);
  };
  const stops = [pointing.stop, listen(true), listen(false)];
  return () => stops.forEach((stop) => stop());
}

// What keys do in the view in use that they don't do in slices across an axis.
function keys_of_its_own(stage: Stage): Record<string, () => void> | null {
  if (stage.active_view === "3d") return stage.overview_keys;
  return stage.viewer.oblique.value === stage.active ? stage.oblique_keys : null;
}

function actions_of(stage: Stage): Record<string, () => void> {
  const { viewer } = stage;
  // One cell of the level shown.
  const crosshair = (du: number, dv: number) => step_crosshair(viewer, stage.active, du, dv);
  const step = (by: number) => {
    viewer.sweeping.value = null;
    viewer.set_slice(stage.active, viewer.cell.value[stage.active] + by);
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
    "+": () => stage.zoom_in_middle(stage.active, ZOOM_STEP),
    "=": () => stage.zoom_in_middle(stage.active, ZOOM_STEP),
    "-": () => stage.zoom_in_middle(stage.active, 1 / ZOOM_STEP),
    "0": () => fit(viewer),
    "1": () => show_cells(viewer),
    Home: () => fit(viewer),
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
    g: () => (viewer.going.value = true),
    h: () => flip(viewer.help),
    "?": () => flip(viewer.help),
    Escape: () => escape(viewer),
    Delete: () => remove_chosen(viewer),
    Backspace: () => remove_chosen(viewer),
  };
}
