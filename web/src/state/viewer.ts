// The state of the page while one grid is open: signals that the views, the panels and the page's address share. These
// parts talk to each other through them alone. Nothing here touches the document.
import { type ReadonlySignal, type Signal, batch, computed, signal } from "@preact/signals";
import { type Axis, axes_of } from "../base/axis";
import { unit_name } from "../base/format";
import { type Amount, type AxisIndex, GridAddress, type GridInfo, type Index3, type Label, type Plane, type Refinement, type Stats, for_axes, without_overlap } from "../base/grid";
import { type LabelLook, type MaterialLook, initial_looks, looks_of_labels } from "../base/materials";
import { upright_axis } from "../base/upright";
import { TileCounters } from "../tiles/counters";
import { type Box, ranges_of, small_labels, with_overlaps } from "./boxes";
import { type Isolation, looks_around, marks_in } from "./isolation";
import { type Range, type ViewSize, fitting_zoom } from "./zoom";

export type ViewName = "x" | "y" | "z" | "3d";
export type Layout = "four" | ViewName;
export type Panel = "materials" | "bodies" | "report" | "box" | "leaves" | "share" | "status";
export type { Box };

// Where the overview's camera is. Angles are in degrees. The distance to the target is counted in halves of the
// domain's longest side, and the target is a point in coordinates.
export interface OrbitState {
  azimuth: number;
  elevation: number;
  distance: number;
  target: [number, number, number];
}
export const BODY_MODES = ["cut", "plane", "whole", "glass"] as const;
// How the overview shows bodies: cut open at the crosshair, cut by a plane through it, whole, or like glass.
export type BodyMode = (typeof BODY_MODES)[number];

export interface Measure {
  id: number; // as long as the page lives
  name: string; // empty until somebody gives it one
  axis: AxisIndex | null; // of the view that it was drawn in; null: in three dimensions
  from: [number, number, number]; // coordinates
  to: [number, number, number];
}

// A place to be marked in the views, such as a hole in a surface.
export interface Marker {
  at: [number, number, number]; // coordinates
  text: string;
  name?: string; // a few words of it, for views
  box?: Box; // where all of it lies
  guess?: boolean; // the box holds what was guessed, such as a cap: it is hatched
}

export const COMPARISON_MODES = ["side", "wipe", "differs"] as const;
// Two slices side by side; one on the other, up to a handle; or what differs.
export type ComparisonMode = (typeof COMPARISON_MODES)[number];

export interface Comparison {
  readonly other: string; // the id of the grid on the right
  readonly axis: AxisIndex; // across which the slices lie
  readonly space: boolean; // whether the grids are seen in three dimensions, in place of slices
  readonly mode: ComparisonMode;
  readonly wipe: number; // where the handle is, as a share of the width
  readonly together: boolean; // whether the slices move together; the crosshair does in any case
  readonly apart: number; // by how much the slice on the right lies farther along the axis, in units of the grid on the left
}

// What the two viewers of a comparison have in common, with each other or with the viewer of the page.
export type Shared = Partial<
  Pick<
    Viewer,
    | "bounds" | "finest" | "cell" | "centre" | "zoom" | "looks" | "body_looks" | "layout" | "help" | "show_axes" | "show_scale" | "show_lines" | "show_outline" | "show_leaves" | "refinement"
    | "tool" | "measures" | "chosen" | "measuring" | "box" | "framed" | "visited" | "orbit" | "bodies" | "plane_normal" | "sky"
  >
>;

export class Viewer {
  readonly address: GridAddress;
  readonly axes: readonly [Axis, Axis, Axis];
  // What can be looked at, and the width of the thinnest cell in it: the grid, or both grids of a comparison.
  readonly bounds: readonly [Range, Range, Range];
  readonly finest: number;
  readonly compared: boolean; // whether it shows one of two slices that are compared, and nothing else

  // The crosshair: a cell of level 0. Each view shows the slice through it.
  readonly cell: Signal<Index3>;
  // What the views look at: the point in the middle of all three, and CSS pixels per unit of length. A zoom of 0 means
  // as large as fits; the views replace it as soon as they know their sizes.
  readonly centre: Signal<[number, number, number]>;
  readonly zoom: Signal<number>;
  // The box, in coordinates, that was framed last, with the middle that the views got by that: it fits them until somebody moves or zooms them.
  readonly framed = signal<{ box: [Range, Range, Range]; centre: [number, number, number] } | null>(null);

  // Whether the slices have been sharp once, or were waited for long enough. All else is asked for after that: the first picture has the
  // machine for itself.
  readonly slices_shown = signal(false);

  // Whether it may turn out yet where to look first (first_view.ts).
  readonly arriving = signal(false);

  // The sizes of the slice views that were in sight last.
  views: readonly ViewSize[] = [];

  readonly layout = signal<Layout>("four");
  readonly compare = signal<Comparison | null>(null); // what the page shows in place of the views
  before: { orbit: OrbitState | null; bodies: BodyMode; centre: [number, number, number]; zoom: number } | null = null; // what was seen before the comparison, if anything was
  readonly help = signal(false); // whether the list of gestures and keys is shown
  readonly figure = signal(false); // whether the dialog that saves a figure is shown
  readonly going = signal(false); // whether the field for a place has the focus
  readonly panel = signal<Panel | null>("materials");
  readonly labels: readonly Label[]; // what the cells carry: materials, or bodies where the file keeps these apart
  readonly looks: Signal<readonly MaterialLook[]>; // of materials
  readonly body_looks = signal<ReadonlyMap<number, Partial<MaterialLook>>>(new Map()); // by label: where a body differs from its material
  readonly label_looks: ReadonlySignal<readonly LabelLook[]>; // as people have chosen them
  readonly isolated = signal<Isolation | null>(null); // what is shown in full, while the rest is faint
  readonly shown_looks: ReadonlySignal<readonly LabelLook[]>; // as the views draw them
  readonly stats = signal<Stats | null>(null); // how much of the grid everything fills, once it is known
  readonly small: ReadonlySignal<ReadonlySet<number>>; // labels that would vanish in glass
  readonly show_axes = signal<boolean>(true);
  readonly show_scale = signal(true);
  readonly show_lines = signal(true); // between cells, when they are large enough
  readonly show_outline = signal(false); // between materials
  readonly show_shares = signal(false); // mixed cells as blends of what they are made of
  readonly show_leaves = signal(false); // lines between the leaves of the refined grid
  readonly refinement: Signal<Refinement>;
  readonly sweeping = signal<AxisIndex | null>(null); // the view whose slices are played
  readonly box = signal<Box | null>(null);
  readonly measures = signal<readonly Measure[]>([]);
  readonly chosen = signal<number | null>(null); // the id of one of them
  readonly measure: ReadonlySignal<Measure | null> = computed(() => this.measures.value.find(({ id }) => id === this.chosen.value) ?? null); // that one
  readonly thickness = signal<Index3 | null>(null); // the cell at which the thickness of its material is measured
  readonly tool = signal<"look" | "measure" | "box">("look");
  readonly measuring = signal<number | null>(null); // the id of the line that has no end yet
  readonly markers = signal<readonly Marker[]>([]);
  readonly marks: ReadonlySignal<readonly Marker[]>; // those that the views draw
  readonly tiles = new TileCounters();
  // The level that each view shows now. A view of a graded grid may show several levels; then it is the finest.
  readonly level: readonly [Signal<number>, Signal<number>, Signal<number>] = [signal(0), signal(0), signal(0)];

  readonly orbit = signal<OrbitState | null>(null); // null: the whole domain is in view
  readonly bodies = signal<BodyMode>("cut");
  readonly plane_normal = signal<[number, number, number] | null>(null); // of the plane that cuts, towards what is cut away, and of the oblique view
  readonly oblique = signal<AxisIndex | null>(null); // the slice view in whose place the oblique view is
  readonly standard_sky: 1 | 2;
  readonly sky: Signal<1 | 2>; // the axis that is up in the overview: y or z
  // Where the overview is to fly to, until it is on its way: a box in coordinates. Of a single point it keeps its distance, and stays where that
  // is in sight.
  readonly visited = signal<[Range, Range, Range] | null>(null);

  // The cell under the pointer, the slice that it is in (null: the overview), and the level of what its labels are of; null outside the grid.
  readonly hover = signal<{ axis: AxisIndex | null; cell: Index3; point: [number, number, number]; labels: readonly number[] | null; level?: number } | null>(null);
  // The plane within the mixed cell under the pointer.
  readonly cut = signal<{ cell: Index3; plane: Plane } | null>(null);
  // A cell that a click keeps in the read-out.
  readonly pinned = signal<Index3 | null>(null);

  // The state at the start. The page's address holds only what differs from it.
  readonly standard_looks: readonly MaterialLook[];
  readonly standard_switches = { show_axes: true, show_scale: true, show_lines: true, show_outline: false, show_shares: false, show_leaves: false } as const;
  readonly standard_refinement: Refinement;

  readonly units: string; // as people write them
  readonly cells: Index3;
  readonly slice: readonly [ReadonlySignal<number>, ReadonlySignal<number>, ReadonlySignal<number>];

  constructor(
    readonly info: GridInfo,
    shared: Shared | null = null,
  ) {
    this.address = new GridAddress(info.id, info.file.hash, this.keeps_bodies);
    this.labels = info.labels ?? info.materials.map(({ id }) => ({ material: id, body: "" }));
    this.axes = axes_of(info);
    this.bounds = this.axes;
    this.finest = Math.min(...this.axes.map((a) => a.finest));
    this.compared = shared !== null;
    this.units = unit_name(info.units);
    this.cells = info.grid.cells;
    this.cell = signal<Index3>(for_axes((d) => Math.floor(this.cells[d] / 2)));
    this.centre = signal(this.middle());
    this.zoom = signal(0);
    this.standard_looks = initial_looks(info.materials);
    this.looks = signal(this.standard_looks);
    this.label_looks = computed(() => looks_of_labels(this.labels, this.looks.value, this.body_looks.value));
    this.shown_looks = computed(() => looks_around(this.label_looks.value, this.isolated.value, this.labels));
    this.marks = computed(() => marks_in(this.markers.value, this.isolated.value));
    this.small = computed(() => {
      const { labels } = this;
      const wholes = small_labels(this.axes, this.amounts ?? [], (label) => labels[label]!.material === 0);
      return new Set(labels.flatMap((_, label) => (wholes.has(without_overlap(labels, label)) ? [label] : [])));
    });
    this.standard_sky = upright_axis(info.report);
    this.sky = signal(this.standard_sky);
    // Some 16 of the coarsest cells along the longest axis.
    this.standard_refinement = { coarsest: Math.min(Math.max(Math.floor(Math.log2(Math.max(...this.cells) / 16)), 1), 8), layers: 2, want: "" };
    this.refinement = signal(this.standard_refinement);
    this.slice = for_axes((d) => computed(() => this.cell.value[d]));
    Object.assign(this, shared);
  }

  get keeps_bodies(): boolean {
    return this.info.labels !== undefined;
  }
  // Whether the file tells what mixed cells are made of.
  get has_shares(): boolean {
    return this.info.channels.some(({ name, coding }) => name === "fractions" && (coding === "stretches" || coding === "shares"));
  }
  // What each label fills, once it is known; what bodies fill is with what lies in others as well.
  get amounts(): readonly Amount[] | null {
    const stats = this.stats.value;
    return stats && (this.keeps_bodies && stats.bodies ? with_overlaps(stats.bodies) : stats.materials);
  }
  // The labels of bodies as wholes, or of materials.
  get wholes(): number[] {
    return this.labels.flatMap(({ overlap }, label) => (overlap ? [] : [label]));
  }
  // The name of each label's material.
  get material_names(): string[] {
    return this.labels.map(({ material }) => this.info.materials[material]!.name);
  }
  // The name of what a label stands for.
  name_of(label: number): string {
    const { material, body, overlap }: Label = this.labels[label] ?? { material: label, body: "" };
    const name = this.info.materials[material]?.name ?? String(material);
    return body ? `${body} · ${name}${overlap ? ", in others too" : ""}` : name;
  }

  // An address that is asked for once the slices have been shown.
  after_slices<T>(address: T): T | null {
    return this.slices_shown.value ? address : null;
  }

  has(cell: Index3): boolean {
    return cell.every((i, d) => i >= 0 && i < this.cells[d]!);
  }
  // The sample point of a cell.
  centre_of(cell: Index3): [number, number, number] {
    return for_axes((d) => this.axes[d].centre(cell[d]));
  }

  middle(): [number, number, number] {
    return for_axes((d) => (this.bounds[d].min + this.bounds[d].max) / 2);
  }

  // The box that the views show as large as fits, if it is not everything.
  get in_frame(): [Range, Range, Range] | null {
    const framed = this.framed.value;
    return framed?.centre === this.centre.value ? framed.box : null;
  }
  // Whether the views show everything, as large as fits.
  shows_all(): boolean {
    const middle = this.middle();
    if (this.in_frame) return false;
    return this.zoom.value === 0 || (this.centre.value.every((x, d) => x === middle[d]) && this.zoom.value === fitting_zoom(this.bounds, this.views));
  }

  // Puts everything but the place back to the start, because an address says only what differs from that.
  reset(): void {
    batch(() => {
      this.layout.value = "four";
      this.compare.value = null;
      this.panel.value = "materials";
      this.looks.value = this.standard_looks;
      this.body_looks.value = new Map();
      this.isolated.value = null;
      for (const name of ["show_axes", "show_scale", "show_lines", "show_outline", "show_shares", "show_leaves"] as const)
        this[name].value = this.standard_switches[name];
      this.refinement.value = this.standard_refinement;
      this.box.value = null;
      this.measures.value = [];
      this.chosen.value = null;
      this.pinned.value = null;
      this.markers.value = [];
      this.orbit.value = null;
      this.bodies.value = "cut";
      this.plane_normal.value = null;
      this.oblique.value = null;
      this.sky.value = this.standard_sky;
    });
  }

  // Moves the slice across an axis; it stays in the grid.
  set_slice(axis: AxisIndex, index: number): void {
    const to = this.axes[axis].clamp(index);
    if (to === this.cell.value[axis]) return;
    const cell: Index3 = [...this.cell.value];
    cell[axis] = to;
    this.cell.value = cell;
  }

  // Puts the crosshair on a cell.
  set_cell(cell: Index3): void {
    const to = for_axes((d) => this.axes[d].clamp(cell[d]));
    if (to.some((x, d) => x !== this.cell.value[d])) this.cell.value = to;
  }

  // Puts the crosshair on a cell, and that cell into the middle of every view.
  go_to_cell(cell: Index3): void {
    batch(() => {
      this.set_cell(cell);
      this.centre.value = this.centre_of(this.cell.value);
    });
  }
  // The same in the overview, too, where the cell isn't in sight.
  look_at_cell(cell: Index3): void {
    batch(() => {
      this.go_to_cell(cell);
      this.visited.value = for_axes((d) => ({ min: this.centre.value[d], max: this.centre.value[d] }));
    });
  }
  go_to(point: readonly [number, number, number]): void {
    this.go_to_cell(for_axes((d) => this.axes[d].cell_at(point[d])));
  }

  // All views come so near that a box, in coordinates, fills a good part of them; the overview flies there.
  frame(box: [Range, Range, Range]): void {
    batch(() => {
      const centre = for_axes((d) => (box[d].min + box[d].max) / 2);
      this.centre.value = centre;
      this.framed.value = { box, centre };
      this.zoom.value = this.views.length ? fitting_zoom(box, this.views) : 0;
      this.visited.value = box;
    });
  }

  // Looks at a box of cells so that all views show the whole of it.
  go_to_box(box: Box): void {
    batch(() => {
      this.go_to(for_axes((d) => (this.axes[d].plane(box[d]) + this.axes[d].plane(box[d + 3]!)) / 2));
      this.frame(ranges_of(this.axes, box));
    });
  }
}
