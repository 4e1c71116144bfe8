// The oblique view. It lies over the slice view whose place it takes, with the angles of its plane in the bar below.
import { type Signal, batch, useSignal } from "@preact/signals";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import { coordinate } from "../base/format";
import { AXES, AXIS_NAMES, type AxisIndex } from "../base/grid";
import { say } from "../base/messages";
import { type Angles, type Vec3, angles_of, normal_of, normal_through, steepest, turned } from "../oblique/frame";
import { type PlaneState, PlaneView, frame_in } from "../oblique/plane_view";
import type { Viewer } from "../state/viewer";
import { ZOOM_STEP } from "../state/zoom";
import { toggle_layout } from "./actions";
import { MaximiseButton } from "./maximise_button";
import { NumberBox } from "./slice_bar";
import type { Stage } from "./stage";
import { ZoomButtons } from "./zoom_buttons";

const TURN = 0.4; // degrees per pixel
const STILL = 4; // CSS pixels that the pointer may move during a click
const WHEEL = 60; // pixels of scrolling per cell
const PAN = 64; // CSS pixels per key
const TURNED = 5; // degrees per key

function take_angles(viewer: Viewer, angles: Signal<Angles>, to: Angles): void {
  batch(() => {
    angles.value = to;
    viewer.plane_normal.value = [...normal_of(to)];
  });
}

// Moves the plane along its normal, by cells of the axis that is nearest to it.
function step_plane(viewer: Viewer, by: number): void {
  const { normal } = frame_in(viewer);
  const axis = steepest(normal);
  viewer.set_slice(axis, viewer.cell.value[axis] + by * Math.sign(normal[axis]));
}

function listen(body: HTMLElement, view: PlaneView, viewer: Viewer, angles: Signal<Angles>): () => void {
  const stop = new AbortController();
  const on = <K extends keyof HTMLElementEventMap>(type: K, call: (event: HTMLElementEventMap[K]) => void) =>
    body.addEventListener(type, call, { signal: stop.signal, passive: false });
  const spot = (event: MouseEvent): [number, number] => {
    const box = body.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  let from: { x: number; y: number; turns: boolean; moved: boolean } | null = null;
  let scrolled = 0;
  on("wheel", (event) => {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === 0 ? 1 : 33);
    if (event.ctrlKey || event.metaKey) return view.zoom_by(Math.exp(-Math.min(Math.max(pixels, -30), 30) / 100), ...spot(event));
    scrolled += pixels;
    const steps = Math.trunc(scrolled / WHEEL);
    scrolled -= steps * WHEEL;
    if (steps !== 0) step_plane(viewer, steps * (event.shiftKey ? 10 : 1));
  });
  on("pointerdown", (event) => {
    body.focus({ preventScroll: true });
    body.setPointerCapture(event.pointerId);
    from = { x: event.clientX, y: event.clientY, turns: event.shiftKey || event.button === 2, moved: false };
  });
  on("pointermove", (event) => {
    const [x, y] = spot(event);
    const { point, cell } = view.under(x, y);
    viewer.hover.value = viewer.has(cell) ? { axis: null, cell, point: [...point], labels: view.labels_at(x, y) } : null;
    if (!from) return;
    const [dx, dy] = [event.clientX - from.x, event.clientY - from.y];
    if (!from.moved && Math.hypot(dx, dy) <= STILL) return;
    from = { ...from, x: event.clientX, y: event.clientY, moved: true };
    if (from.turns) take_angles(viewer, angles, turned(angles.value, -dx * TURN, dy * TURN));
    else view.pan(dx, dy);
  });
  on("pointerup", (event) => {
    const { cell } = view.under(...spot(event));
    if (from && !from.moved && !from.turns && viewer.has(cell)) {
      const again = viewer.pinned.value?.every((i, d) => i === cell[d]) ?? false;
      batch(() => {
        viewer.set_cell(cell);
        viewer.pinned.value = again ? null : cell;
      });
    }
    from = null;
  });
  on("pointercancel", () => (from = null));
  on("pointerleave", () => (viewer.hover.value = null));
  on("contextmenu", (event) => event.preventDefault());
  return () => stop.abort();
}

// Takes the plane through the next three cells that are pinned, in any view.
function use_three_points(viewer: Viewer, angles: Signal<Angles>): Signal<Vec3[] | null> {
  const points = useSignal<Vec3[] | null>(null);
  const pinned = viewer.pinned.value;
  useEffect(() => {
    const so_far = points.peek();
    if (!so_far || !pinned) return;
    const now = [...so_far, viewer.centre_of(pinned)];
    if (now.length < 3) return void (points.value = now);
    points.value = null;
    const normal = normal_through(now as [Vec3, Vec3, Vec3]);
    if (!normal) return say("These three points lie on one line, so there is no plane through them alone.");
    // Seen from the same side as before.
    const before = frame_in(viewer).normal;
    const side = before.reduce((sum, x, d) => sum + x * normal[d]!, 0) < 0 ? -1 : 1;
    take_angles(viewer, angles, angles_of(normal.map((x) => x * side) as [number, number, number]));
  }, [pinned]);
  useEffect(() => {
    const stop = new AbortController();
    const on_key = (event: KeyboardEvent) => event.key === "Escape" && (points.value = null);
    if (points.value) document.addEventListener("keydown", on_key, { signal: stop.signal });
    return () => stop.abort();
  }, [points.value !== null]);
  return points;
}

// Arrows move the picture, with shift they turn the plane.
function keys_of(view: PlaneView, viewer: Viewer, angles: Signal<Angles>): Record<string, () => void> {
  const zoom = (factor: number) => () => view.zoom_in_middle(factor);
  const turn = (azimuth: number, elevation: number) => () => take_angles(viewer, angles, turned(angles.value, azimuth, elevation));
  const step = (by: number) => () => step_plane(viewer, by);
  return {
    ArrowLeft: () => view.pan(PAN, 0),
    ArrowRight: () => view.pan(-PAN, 0),
    ArrowUp: () => view.pan(0, PAN),
    ArrowDown: () => view.pan(0, -PAN),
    "Shift+ArrowLeft": turn(-TURNED, 0),
    "Shift+ArrowRight": turn(TURNED, 0),
    "Shift+ArrowUp": turn(0, TURNED),
    "Shift+ArrowDown": turn(0, -TURNED),
    "+": zoom(ZOOM_STEP),
    "=": zoom(ZOOM_STEP),
    "-": zoom(1 / ZOOM_STEP),
    ",": step(-1),
    ".": step(1),
    "<": step(-10),
    ">": step(10),
    ";": step(-10),
    ":": step(10),
  };
}

export function ObliquePanel({ stage, viewer, axis }: { stage: Stage; viewer: Viewer; axis: AxisIndex }) {
  const body = useRef<HTMLDivElement>(null);
  const view = useRef<PlaneView | null>(null);
  const state = useSignal<PlaneState>({ waiting: true, damaged: false, trouble: "" });
  const angles = useSignal(angles_of(frame_in(viewer).normal));
  const points = use_three_points(viewer, angles);
  const frame = frame_in(viewer);
  // Others may turn the plane, too: the 3D view does.
  const now = normal_of(angles.value);
  if (frame.normal.some((x, d) => Math.abs(x - now[d]!) > 1e-9)) angles.value = angles_of(frame.normal);
  useLayoutEffect(() => {
    const element = body.current!;
    const made = (view.current = new PlaneView(viewer, element, (now) => (state.value = now)));
    const stop = listen(element, made, viewer, angles);
    stage.oblique_keys = keys_of(made, viewer, angles);
    return () => {
      stage.oblique_keys = null;
      stop();
      made.stop();
    };
  }, [viewer]);
  const { waiting, damaged, trouble } = state.value;
  const place = AXES.map((d) => coordinate(frame.through[d], viewer.axes[d].width(viewer.cell.value[d]))).join(", ");
  const turn = (name: "azimuth" | "elevation", to: number) => take_angles(viewer, angles, turned({ ...angles.value, [name]: to }, 0, 0));
  const angle = (name: "azimuth" | "elevation", most: number) => {
    const degrees = Number(angles.value[name].toFixed(1));
    const title = name === "azimuth" ? "Azimuth: how far the plane's normal is turned round z, from x" : "Elevation: how far the plane's normal is above the plane of x and y";
    return (
      <>
        <span class="oblique-name" aria-hidden="true">
          {name}
        </span>
        <input type="range" aria-label={title} title={title} min={-most} max={most} step={0.5} value={degrees} aria-valuetext={`${degrees}°`} onInput={(e) => turn(name, e.currentTarget.valueAsNumber)} />
        <NumberBox label={`${title}, in degrees`} text={String(degrees)} width={5} suffix="°" take={(to) => turn(name, to)} />
      </>
    );
  };
  return (
    <div class="oblique" data-state={waiting ? "waiting" : "sharp"}>
      <div class="view-body" ref={body} tabIndex={0} role="application" aria-roledescription="oblique slice view" aria-label={`Slice along the plane through ${place}, azimuth ${angles.value.azimuth.toFixed(1)}°, elevation ${angles.value.elevation.toFixed(1)}°`} />
      <header class="view-head">
        <div class="view-title">
          <span class="view-chip" aria-hidden="true">
            ∠
          </span>
          <span class="view-place">
            <span class="view-wide">through </span>
            {place} {viewer.units}
          </span>
          {damaged && (
            <span class="view-damaged" role="status" title="This part of the file can't be read. “teracell verify” says what is damaged.">
              <span class="view-wide">striped: </span>unreadable
            </span>
          )}
          <span class={waiting ? "view-waiting" : "view-waiting view-still"} role="status" aria-label={waiting ? "Loading" : undefined} />
        </div>
        <MaximiseButton what="The oblique view" alone={viewer.layout.value === AXIS_NAMES[axis]} toggle={() => toggle_layout(viewer, AXIS_NAMES[axis])} />
      </header>
      <ZoomButtons viewer={viewer} zoom={(factor) => view.current?.zoom_in_middle(factor)} />
      {trouble && (
        <div class="view-note" role="alert">
          <p>The oblique slice can't be shown: {trouble}.</p>
          <button onClick={() => view.current?.again()}>Try again</button>
        </div>
      )}
      {points.value && (
        <p class="tool-note" role="status">
          Click {["three points", "two more points", "one more point"][points.value.length]} in any view; press Escape to stop
        </p>
      )}
      <div class="slice-bar oblique-bar">
        {angle("azimuth", 180)}
        {angle("elevation", 90)}
        <button class="slice-button oblique-three" title="A plane through three points, which you click in any view" aria-label="Through three points" aria-pressed={points.value !== null} onClick={() => (points.value = points.value ? null : [])}>
          <svg viewBox="0 0 16 16" width="14" height="14" aria-hidden="true" fill="none" stroke="currentColor" stroke-width="1.4">
            <path d="M3 12.5 8 3l5 9.5z" stroke-dasharray="2 1.5" />
            <path d="M3 12.5h.01M8 3h.01M13 12.5h.01" stroke-width="3.6" stroke-linecap="round" />
          </svg>
        </button>
        <button class="slice-button" title={`Back to the slices across ${AXIS_NAMES[axis]} (o)`} aria-label={`Back to the slices across ${AXIS_NAMES[axis]}`} onClick={() => (viewer.oblique.value = null)}>
          <svg viewBox="0 0 16 16" width="14" height="14" aria-hidden="true" stroke="currentColor" stroke-width="1.8">
            <path d="m4 4 8 8M12 4l-8 8" />
          </svg>
        </button>
      </div>
    </div>
  );
}
