// The two viewers of a comparison, and the stages that draw them. They share the camera, so each point lies at the same place
// in both; each grid has its own tiles.
import { type Signal, effect, signal } from "@preact/signals";
import { axes_of } from "../base/axis";
import { AXIS_NAMES, type GridInfo } from "../base/grid";
import { common_bounds, in_units, link, looks_by_name } from "../state/comparison";
import { type Comparison, type Layout, type Shared, Viewer } from "../state/viewer";
import { fit } from "../views/actions";
import { attach_keys } from "../views/keys";
import { Stage } from "../views/stage";
import { attach_sweep } from "../views/sweep";
import { expose } from "../views/testing";

// The box of a change that was gone to, and whether the view in three dimensions is still to frame it. Slices and that view have pairs of their own;
// this is of both.
export type GoneTo = Pick<Viewer, "box" | "visited">;

export class Pair {
  readonly left: Stage;
  readonly right: Stage;
  // Counts the frames that were drawn.
  readonly frames = signal(0);
  // The stage that keys act on.
  in_use: Stage;
  private readonly comparison: Signal<Comparison | null>;

  // `page`: the viewer whose grid stands on the left; its crosshair and its camera move along.
  constructor(
    private readonly page: Viewer,
    other: GridInfo,
    gone_to: GoneTo,
  ) {
    this.comparison = page.compare;
    const right = in_units(other, page.info.units);
    const axes = [page.axes, axes_of(right)] as const;
    const { centre, zoom, framed, help, show_axes, show_scale, show_lines, show_outline, show_leaves, refinement, tool, measures, chosen, measuring, orbit, bodies, plane_normal, sky } = page;
    const shared: Shared = {
      ...{ centre, zoom, framed, help, show_axes, show_scale, show_lines, show_outline, show_leaves, refinement, tool, measures, chosen, measuring, orbit, bodies, plane_normal, sky },
      bounds: common_bounds(...axes),
      finest: Math.min(...axes.flat().map((axis) => axis.finest)),
      layout: signal<Layout>("z"),
      ...gone_to,
    };
    this.left = new Stage(new Viewer(page.info, { ...shared, cell: page.cell, looks: page.looks, body_looks: page.body_looks }));
    this.right = new Stage(new Viewer(right, shared));
    this.in_use = this.left;
  }

  // Starts to draw into what is below `host`. Returns a function that ends it.
  start(host: HTMLElement): () => void {
    const [left, right] = [this.left.viewer, this.right.viewer];
    for (const stage of [this.left, this.right]) stage.on_draw = () => void ++this.frames.value;
    if (left.zoom.value === 0 && !left.in_frame) fit(left);
    const stops = [
      effect(() => {
        const c = this.comparison.value;
        if (c) left.layout.value = c.space ? "3d" : AXIS_NAMES[c.axis];
        if (c?.space) left.slices_shown.value = right.slices_shown.value = true; // there are none to wait for
      }),
      link(left, right, this.comparison),
      effect(() => void (right.looks.value = looks_by_name(left.info.materials, left.looks.value, right.info.materials, right.standard_looks))),
      this.left.start(host),
      this.right.start(host),
      attach_keys(() => this.in_use),
      attach_sweep(this.left),
      attach_sweep(this.right),
      expose(this.left, this.right),
    ];
    return () => {
      // Who saw all of both grids sees all of what comes next.
      if (left.shows_all()) fit(this.page);
      stops.forEach((stop) => stop());
    };
  }
}
