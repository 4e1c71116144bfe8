// The three slice views together. A frame is drawn only when something has changed. It finds out what each view shows
// and what it lacks, tells the store which tiles are wanted, paints, and sets the signals that follow from it: the
// level shown and the cell under the pointer.
import { type ReadonlySignal, type Signal, batch, effect, signal } from "@preact/signals";
import { FRAMES } from "../base/axis";
import { AXIS_NAMES, type AxisIndex, without_overlap } from "../base/grid";
import { say, words_of } from "../base/messages";
import { get } from "../server/api";
import { returned } from "../server/connection";
import { on_theme } from "../state/theme";
import type { Box, ViewName, Viewer } from "../state/viewer";
import { clamped_zoom, fitting_zoom } from "../state/zoom";
import { Palette, SetTable } from "../tiles/sets";
import { type LeafTile, decode_leaf_tile } from "../tiles/leaf_tile";
import { TileCounters } from "../tiles/counters";
import { LIMITS, TileStore } from "../tiles/store";
import { type Tile, decode_tile } from "../tiles/tile";
import { wants_of } from "../tiles/wants";
import { zoomed_about } from "./drawing/camera";
import { type Ink, read_ink } from "./drawing/ink";
import { draw_overlay } from "./overlay";
import { type Scene, View } from "./view";

const stages = new WeakMap<Viewer, Stage>();
export const stage_of = (viewer: Viewer): Stage | undefined => stages.get(viewer);

// Does something each time when a signal has changed.
function after(changing: ReadonlySignal<unknown>, act: () => void): () => void {
  let first = true;
  return effect(() => {
    changing.value;
    if (!first) act();
    first = false;
  });
}

const SLOW = 24; // milliseconds: if painting takes longer on average, fine screens get one pixel per CSS pixel
const FINEST = 2; // device pixels per CSS pixel
const REST = 500; // milliseconds without a change, after which all device pixels are used again
const KEPT_TIMES = 4096;
const FOR_LEAVES = { ...LIMITS, bytes: 16 * 2 ** 20, requests: 2 };
const LONGEST_WAIT = 2000; // milliseconds after which other requests wait no longer for slices

export class Stage {
  readonly views: readonly [View, View, View] = [new View(0), new View(1), new View(2)];
  readonly sets: SetTable;
  readonly store: TileStore<Tile>;
  readonly leaves: TileStore<LeafTile>;
  // Called at the end of each frame that was drawn.
  on_draw: () => void = () => {};
  // From the start of a frame that changed pixels to the start of the next, in milliseconds.
  readonly frame_times: number[] = [];
  // A box that is being drawn.
  readonly draft = signal<Box | null>(null);
  // Whether a view waits for tiles.
  readonly waiting: readonly [Signal<boolean>, Signal<boolean>, Signal<boolean>] = [signal(false), signal(false), signal(false)];
  readonly together: readonly [Signal<boolean>, Signal<boolean>, Signal<boolean>] = [signal(false), signal(false), signal(false)]; // bodies of one material
  // Whether the server could not read something that a view shows.
  readonly damaged: readonly [Signal<boolean>, Signal<boolean>, Signal<boolean>] = [signal(false), signal(false), signal(false)];
  // The slice that a view still shows in place of its own.
  readonly stale: readonly [Signal<number | null>, Signal<number | null>, Signal<number | null>] = [signal(null), signal(null), signal(null)];
  // The view that keys act on: its panel has the pointer or the focus. `active` is the last such view that shows
  // slices.
  active_view: ViewName = "z";
  active: AxisIndex = 2;
  // What keys do in the overview, once it is there.
  overview_keys: Readonly<Record<string, () => void>> | null = null;
  oblique_keys: Readonly<Record<string, () => void>> | null = null;

  private readonly palette: Palette;
  private ink: Ink | null = null;
  private host: HTMLElement | null = null;
  private dirty = true;
  private request = 0;
  private fitted = 0; // the zoom that fitted the views when they were drawn last
  private last_start = 0;
  private drew = false;
  private cost = 0; // a moving mean, milliseconds
  private most_ratio = FINEST;
  private rest = 0;
  private timer = 0;
  private readonly stops: (() => void)[] = [];

  constructor(readonly viewer: Viewer) {
    const { address, cells, labels } = viewer;
    this.sets = new SetTable((label) => without_overlap(labels, label));
    this.palette = new Palette(this.sets);
    const shares = () => viewer.show_shares.peek() && viewer.has_shares;
    this.store = new TileStore(
      {
        address: (p) => address.tile(p.axis, p.index, p.level, p.column, p.row, shares()),
        what_is_left: (p) => address.damaged_tile(p.axis, p.index, p.level, p.column, p.row),
        decode: (place, size, buffer) => decode_tile(place, size, buffer, this.sets),
      },
      cells,
      viewer.tiles,
      get,
    );
    this.leaves = new TileStore(
      { address: (p) => address.leaves(viewer.refinement.peek(), p.axis, p.index, p.level, p.column, p.row), decode: decode_leaf_tile },
      cells,
      new TileCounters(),
      get,
      FOR_LEAVES,
    );
    for (const store of [this.store, this.leaves]) store.on_change = () => this.invalidate();
    let told = "";
    this.leaves.on_refused = (error) => {
      const text = `The leaves can't be drawn: ${words_of(error)}.`;
      if (text !== told) say(text);
      told = text;
    };
  }

  // Starts to draw, with the colours that the style sheet gives to `host`. Returns a function that ends it.
  start(host: HTMLElement): () => void {
    this.host = host;
    stages.set(this.viewer, this);
    const { viewer: v } = this;
    const timer = window.setTimeout(() => (v.slices_shown.value = true), LONGEST_WAIT);
    this.stops.push(
      effect(() => {
        for (const s of [
          v.slices_shown, v.cell, v.centre, v.zoom, v.layout, v.shown_looks, v.show_axes, v.show_scale, v.show_lines, v.show_outline, v.show_shares, v.show_leaves, v.cut, v.box, v.measures, v.chosen, v.pinned,
          v.markers, v.isolated, this.draft,
        ])
          s.value;
        this.invalidate();
      }),
      () => clearTimeout(timer),
      after(v.show_shares, () => this.store.renew(({ level }) => level === 0)),
      after(v.refinement, () => this.leaves.renew(() => true)),
      // Keys act on a view that is shown alone, even before the pointer is over it.
      effect(() => void (v.layout.value !== "four" && this.activate(v.layout.value))),
      effect(() => {
        if (returned.value > 0) for (const store of [this.store, this.leaves]) store.retry();
      }),
      on_theme(() => {
        this.ink = null;
        this.invalidate();
      }),
    );
    return () => this.stop();
  }

  // Puts a view into an element and follows its size.
  attach(axis: AxisIndex, body: HTMLElement): () => void {
    const view = this.views[axis];
    body.prepend(view.cells, view.overlay);
    const measure = () => {
      if (view.cells.parentElement !== body) return;
      view.width = body.clientWidth;
      view.height = body.clientHeight;
      this.invalidate();
    };
    queueMicrotask(measure); // when all views are in their places, so that the page is laid out once
    const sizes = new ResizeObserver(measure);
    sizes.observe(body);
    return () => {
      sizes.disconnect();
      view.cells.remove();
      view.overlay.remove();
      view.width = 0;
    };
  }

  activate(view: ViewName): void {
    this.active_view = view;
    if (view !== "3d") this.active = AXIS_NAMES.indexOf(view) as AxisIndex;
  }

  invalidate(): void {
    this.dirty = true;
    if (!this.request && this.host) this.request = requestAnimationFrame(this.frame);
  }

  get visible(): View[] {
    return this.views.filter((view) => view.visible);
  }

  // Whether the screen does not yet show what the signals say.
  get changing(): boolean {
    return this.dirty;
  }

  // Whether everything in sight is sharp and on the screen.
  idle(): boolean {
    const zoomed = this.viewer.zoom.value > 0 || this.visible.length === 0; // only slices settle it
    return !this.dirty && !this.viewer.arriving.value && this.laid_out() && zoomed && this.views.every((view) => view.sharp);
  }

  // Whether the views have the sizes of the layout, which they get shortly after it changes.
  private laid_out(): boolean {
    const layout = this.viewer.layout.value;
    return this.views.every(({ axis, width }) => width > 0 === (layout === "four" || layout === AXIS_NAMES[axis]));
  }

  fitting(): number {
    const visible = this.visible;
    return visible.length ? fitting_zoom(this.viewer.bounds, visible) : 0;
  }

  // A grid that fits its views continues to fit when their sizes change, until somebody zooms or moves it; so does a box in it that is framed. A zoom
  // that comes from elsewhere, such as an address, is kept within the limits of zooming.
  private settle_zoom(): void {
    const { centre, finest, in_frame, zoom } = this.viewer;
    const [all, middle] = [this.fitting(), this.viewer.middle()];
    const fitting = in_frame ? clamped_zoom(fitting_zoom(in_frame, this.visible), finest, all) : all;
    const fits = zoom.value === 0 || (zoom.value === this.fitted && (in_frame || centre.value.every((x, d) => x === middle[d])));
    zoom.value = fits ? fitting : clamped_zoom(zoom.value, finest, all);
    this.fitted = fitting;
    this.viewer.views = this.visible.map(({ axis, width, height }) => ({ axis, width, height }));
  }

  // Zooms by a factor. The point under (x, y), in CSS pixels of the view, stays where it is.
  zoom_by(axis: AxisIndex, factor: number, x: number, y: number): void {
    if (this.viewer.zoom.value === 0) return;
    const camera = this.views[axis].camera_of(this.viewer, 1);
    const zoom = clamped_zoom(this.viewer.zoom.value * factor, this.viewer.finest, this.fitting());
    this.look_at(axis, zoomed_about(camera, x, y, zoom));
    this.viewer.zoom.value = zoom;
  }

  zoom_in_middle(axis: AxisIndex, factor: number): void {
    const { width, height } = this.views[axis];
    this.zoom_by(axis, factor, width / 2, height / 2);
  }

  pan(axis: AxisIndex, dx: number, dy: number): void {
    if (this.viewer.zoom.value === 0) return;
    const { u, v } = FRAMES[axis];
    const { centre, zoom } = this.viewer;
    this.look_at(axis, [centre.value[u] - dx / zoom.value, centre.value[v] + dy / zoom.value]);
  }

  // The middle stays within what can be looked at.
  private look_at(axis: AxisIndex, [a, b]: readonly [number, number]): void {
    const { bounds } = this.viewer;
    const centre: [number, number, number] = [...this.viewer.centre.value];
    const inside = (d: AxisIndex, x: number) => Math.min(Math.max(x, bounds[d].min), bounds[d].max);
    centre[FRAMES[axis].u] = inside(FRAMES[axis].u, a);
    centre[FRAMES[axis].v] = inside(FRAMES[axis].v, b);
    this.viewer.centre.value = centre;
  }

  // What views and overlays are drawn with, on the screen and in saved pictures.
  scene(ratio: number): Scene | null {
    if (!this.host) return null;
    const { viewer, store, leaves, palette } = this;
    return { viewer, store, leaves, palette, ink: (this.ink ??= read_ink(this.host)), ratio };
  }

  private readonly frame = (start: number): void => {
    if (this.drew && start - this.last_start < 1000) {
      if (this.frame_times.length >= KEPT_TIMES) this.frame_times.splice(0, KEPT_TIMES / 2);
      this.frame_times.push(start - this.last_start);
    }
    this.request = 0;
    this.drew = false;
    if (this.dirty) {
      this.dirty = false;
      this.drew = batch(() => this.draw()); // what the page says of the views changes once, after all of them
      if (!this.dirty && this.laid_out() && this.views.every((view) => view.sharp)) this.viewer.slices_shown.value = true;
    }
    this.last_start = start;
    // One more frame tells how long this one took.
    if (this.drew && !this.request) this.request = requestAnimationFrame(this.frame);
  };

  private draw(): boolean {
    const { viewer, store, palette } = this;
    const views = this.visible;
    const scene = this.scene(Math.min(devicePixelRatio, this.most_ratio));
    if (!scene || views.length === 0) return false;
    const began = performance.now();
    if (this.laid_out()) this.settle_zoom();
    if (viewer.zoom.value === 0) return false; // it is drawn when the sizes are known
    for (const view of views) view.look(scene, began);
    const wants = wants_of(views.map((view) => view.needs(viewer, view.axis === this.active)), viewer.info.levels.length, viewer.cells);
    store.want(viewer.slices_shown.peek() ? wants : wants.filter(({ ahead }) => !ahead));
    this.leaves.want(
      [...views]
        .sort((a, b) => Number(b.axis === this.active) - Number(a.axis === this.active))
        .flatMap((view) => view.leaves?.missing ?? [])
        .map((place) => ({ place, ahead: false })),
    );
    palette.update(viewer.shown_looks.value, scene.ink.ground, scene.ink.outside);
    let painted = false;
    for (const view of views) {
      painted = view.paint(scene) || painted;
      painted = draw_overlay(scene, view, this.draft.value) || painted;
      viewer.level[view.axis].value = view.level;
      this.together[view.axis].value = view.shown.regions.some(({ tile }) => tile?.apart === false);
      this.stale[view.axis].value = view.stale_slice;
      this.damaged[view.axis].value = view.shown.regions.some((region) => region.damaged);
    }
    for (const view of this.views) this.waiting[view.axis].value = !view.sharp; // a hidden view waits for nothing
    this.say_what_is_under_the_pointer();
    this.on_draw();
    this.wait_for_patience(views, began);
    if (painted) this.watch_cost(performance.now() - began);
    return painted;
  }

  private wait_for_patience(views: readonly View[], now: number): void {
    clearTimeout(this.timer);
    const ends = views.flatMap((view) => (view.impatient_at !== null && view.impatient_at > now ? [view.impatient_at] : []));
    if (ends.length) this.timer = window.setTimeout(() => this.invalidate(), Math.min(...ends) - now + 1);
  }

  private watch_cost(milliseconds: number): void {
    this.cost += (milliseconds - this.cost) / 10;
    if (this.cost > SLOW) this.most_ratio = 1;
    clearTimeout(this.rest);
    if (this.most_ratio < FINEST) this.rest = window.setTimeout(() => this.sharpen(), REST);
  }

  private sharpen(): void {
    this.most_ratio = FINEST;
    this.cost = 0;
    this.invalidate();
  }

  private say_what_is_under_the_pointer(): void {
    const { viewer } = this;
    const view = this.visible.find(({ pointer }) => pointer !== null);
    const before = viewer.hover.value;
    if (!view?.pointer || !view.camera) {
      if (before && before.axis !== null) viewer.hover.value = null;
      return;
    }
    const { point, cell } = view.under(viewer, view.pointer.x, view.pointer.y);
    if (!viewer.has(cell)) {
      if (before) viewer.hover.value = null;
      return;
    }
    const { u, v, w } = FRAMES[view.axis];
    const finest = view.finest_at(this.store, cell[w], cell[u], cell[v], viewer.info.levels.length);
    const labels = finest && this.sets.members(finest.set);
    const level = finest?.level ?? 0;
    const same =
      before &&
      before.axis === view.axis &&
      before.labels === labels &&
      before.level === level &&
      before.point.every((x, d) => x === point[d]) &&
      before.cell[w] === cell[w];
    if (!same) viewer.hover.value = { axis: view.axis, cell, point, labels, level };
  }

  private stop(): void {
    cancelAnimationFrame(this.request);
    clearTimeout(this.timer);
    clearTimeout(this.rest);
    for (const stop of this.stops) stop();
    stages.delete(this.viewer);
    this.host = null;
    this.viewer.hover.value = null;
    this.store.close();
    this.leaves.close();
  }
}
