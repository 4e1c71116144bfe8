// One slice view: the canvas of its cells, the canvas of overlays above it, and what was painted last, so that a frame
// does only what has changed. It knows neither gestures nor requests; stage.ts drives it.
import { FRAMES } from "../base/axis";
import type { AxisIndex, Index3 } from "../base/grid";
import type { Viewer } from "../state/viewer";
import { cover } from "../tiles/cover";
import type { Extent, Place } from "../tiles/place";
import { type Region, type Shown, regions_of } from "../tiles/regions";
import type { LeafTile } from "../tiles/leaf_tile";
import { type Palette, UNKNOWN } from "../tiles/sets";
import type { TileStore } from "../tiles/store";
import { type Tile, set_at } from "../tiles/tile";
import type { ViewNeeds } from "../tiles/wants";
import { Camera, type SampleCells, sample_cells } from "./drawing/camera";
import type { Ink } from "./drawing/ink";
import { paint_leaves } from "./drawing/leaf_lines";
import { number_at, paint, paint_damaged, paint_outline } from "./drawing/paint";

// Milliseconds for which an earlier slice may stay although a coarse tile of the right slice is there.
const PATIENCE = 150;
const SHARP_FROM = 3; // device pixels: cells this large have sharp edges

export interface Scene {
  readonly viewer: Viewer;
  readonly store: TileStore<Tile>;
  readonly leaves: TileStore<LeafTile>;
  readonly palette: Palette;
  readonly ink: Ink;
  readonly ratio: number; // device pixels per CSS pixel
}

export class View {
  readonly cells = document.createElement("canvas");
  readonly overlay = document.createElement("canvas");
  width = 0; // CSS pixels; 0 while hidden
  height = 0;
  camera: Camera | null = null;
  samples: SampleCells | null = null;
  places: readonly Place[] = [];
  shown: Shown = { regions: [], missing: [], blank: [], stale: false };
  leaves: Shown<LeafTile> | null = null; // where they are to be drawn
  stride = 0;
  // Where the pointer is, in CSS pixels.
  pointer: { x: number; y: number } | null = null;
  private readonly context = this.cells.getContext("2d", { alpha: false })!;
  private picture: ImageData | null = null;
  private painted: readonly Region[] = [];
  private painted_samples: SampleCells | null = null;
  private shown_slice: number | null = null;
  private last_slice: number | null = null;
  private behind_since: number | null = null;
  private camera_key = "";
  picture_key = ""; // changes with the picture

  constructor(readonly axis: AxisIndex) {
    this.cells.className = "view-cells";
    this.cells.hidden = true; // until something has come
    this.overlay.className = "view-overlay";
  }

  get visible(): boolean {
    return this.width >= 8 && this.height >= 8;
  }

  // Whether everything in sight is of the finest level and the right slice.
  get sharp(): boolean {
    return !this.visible || (this.camera !== null && this.shown.missing.length === 0 && !this.leaves?.missing.length);
  }

  // The camera as the signals say now. The screen follows with the next frame.
  camera_of(viewer: Viewer, ratio: number): Camera {
    return new Camera(this.axis, viewer.axes, this.width, this.height, ratio, viewer.centre.value, viewer.zoom.value);
  }

  // What lies at (x, y), in CSS pixels: a point of the slice and its cell, which may be outside the grid.
  under(viewer: Viewer, x: number, y: number): { point: [number, number, number]; cell: Index3 } {
    const camera = this.camera_of(viewer, 1);
    const { u, v } = FRAMES[this.axis];
    const cell: Index3 = [...viewer.cell.value];
    const point = viewer.centre_of(cell);
    [point[u], point[v]] = [camera.u_at(x), camera.v_at(y)];
    for (const d of [u, v]) cell[d] = viewer.axes[d].cell_at(point[d]);
    return { point, cell };
  }

  // The first half of a frame: finds out which tiles are wanted. `now` is in milliseconds.
  look({ viewer, store, leaves, ratio }: Scene, now: number): void {
    const slice = viewer.slice[this.axis].value;
    if (this.last_slice !== null && slice !== this.last_slice) this.stride = slice - this.last_slice;
    this.last_slice = slice;
    const [centre, zoom] = [viewer.centre.value, viewer.zoom.value];
    const { u, v } = FRAMES[this.axis];
    const key = [this.width, this.height, ratio, centre[u], centre[v], zoom].join(" ");
    if (key !== this.camera_key || !this.camera) {
      this.camera_key = key;
      this.camera = this.camera_of(viewer, ratio);
      this.samples = samples_of(this.camera);
    }
    const levels = viewer.info.levels.length;
    this.places = cover({ axis: this.axis, slice, axes: viewer.axes, levels, scale: zoom * ratio, seen: this.camera.seen() });
    const patient = this.behind_since === null || now - this.behind_since < PATIENCE;
    this.shown = regions_of(this.places, slice, levels, viewer.cells, store, { slice: this.shown_slice, patient });
    this.leaves = viewer.show_leaves.value ? regions_of(this.places, slice, levels, viewer.cells, leaves, { slice: null, patient: false }) : null;
    if (this.shown.stale) this.behind_since ??= now;
    else {
      this.behind_since = null;
      this.shown_slice = slice;
    }
  }

  // When the picture changes even if no tile comes, because an earlier slice has stayed long enough; null: it does not.
  get impatient_at(): number | null {
    return this.behind_since === null ? null : this.behind_since + PATIENCE;
  }

  // The earlier slice that is still shown; null: it is the right one.
  get stale_slice(): number | null {
    return this.shown.stale ? this.shown_slice : null;
  }

  get level(): number {
    return this.places.reduce((least, { level }) => Math.min(least, level), this.places[0]?.level ?? 0);
  }

  // The second half of a frame. True when pixels have changed.
  paint({ viewer, palette, ink }: Scene): boolean {
    const samples = this.samples!;
    const [width, height] = [samples.columns.length / samples.each, samples.rows.length / samples.each];
    const outline = viewer.show_outline.value;
    const key = `${this.camera_key} ${palette.version} ${outline} ${viewer.show_shares.value} ${this.shown.regions.map(region_key).join(" ")} ${this.leaf_key(viewer)}`;
    if (key === this.picture_key) return false;
    if (this.cells.hidden && this.shown.regions.every(({ tile, damaged }) => !tile && !damaged)) return false;
    this.cells.hidden = false;
    this.picture_key = key;
    if (!this.picture || this.picture.width !== width || this.picture.height !== height) {
      this.cells.width = width;
      this.cells.height = height;
      this.picture = new ImageData(width, height);
    }
    const out = new Uint32Array(this.picture.data.buffer);
    const { regions } = this.shown;
    paint(out, samples, regions, palette.colors);
    if (outline) paint_outline(out, samples, regions, ink.outline);
    if (this.leaves) paint_leaves(out, samples, this.leaves.regions);
    paint_damaged(out, samples, regions, ...ink.stripes);
    this.context.putImageData(this.picture, 0, 0);
    this.painted = regions;
    this.painted_samples = samples;
    return true;
  }

  private leaf_key({ refinement }: Viewer): string {
    return this.leaves ? `${Object.values(refinement.value).join(" ")} ${this.leaves.regions.map(region_key).join(" ")}` : "";
  }

  // What a frame needs from the server.
  needs(viewer: Viewer, first: boolean): ViewNeeds {
    const camera = this.camera!;
    const { x, y } = this.pointer ?? { x: this.width / 2, y: this.height / 2 };
    const focus = [camera.across.cell_at(camera.u_at(x)), camera.up.cell_at(camera.v_at(y))] as const;
    const { missing, blank } = this.shown;
    return { places: this.places, missing, blank, slice: viewer.slice[this.axis].value, stride: this.stride, first, focus };
  }

  // The number of the set painted under a CSS pixel; null where nothing has come, or outside the grid.
  painted_at(x: number, y: number): number | null {
    const samples = this.painted_samples;
    if (!samples || !this.camera) return null;
    const sample = (css: number) => Math.floor(css * this.camera!.ratio) * samples.each;
    const number = number_at(samples, this.painted, sample(x), sample(y));
    return number > UNKNOWN ? number : null;
  }

  // The number of the set at a cell of the slice, and its level, from the finest tile that is there; null when there is none.
  finest_at(store: TileStore<Tile>, slice: number, u: number, v: number, levels: number): { set: number; level: number } | null {
    for (let level = 0; level < levels; ++level) {
      const tile = store.find({ axis: this.axis, index: slice >> level, level, column: (u >> level) >> 9, row: (v >> level) >> 9 });
      if (tile) return { set: set_at(tile, u, v), level };
    }
    return null;
  }
}

// How many samples a device pixel has along each axis.
export const samples_for = (camera: Camera): 1 | 2 => (smallest_cell(camera) < SHARP_FROM ? 2 : 1);
export const samples_of = (camera: Camera): SampleCells => sample_cells(camera, samples_for(camera));

// The mean size of a cell of level 0 in device pixels. Cells of coarser levels are never large.
function smallest_cell({ across, up, zoom, ratio }: Camera): number {
  return Math.min((across.max - across.min) / across.cells, (up.max - up.min) / up.cells) * zoom * ratio;
}

const extent_key = (e: Extent) => `${e.u0},${e.v0},${e.u1},${e.v1}`;
const region_key = (region: Region<{ name: string }>) => `${region.tile?.name ?? (region.damaged ? "!" : "?")}@${extent_key(region)}`;
