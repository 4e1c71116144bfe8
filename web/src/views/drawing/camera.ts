// Where cells are on a view. x and y are CSS pixels from the view's top left corner, x to the right and y down; u
// points right and v points up. Everything is computed in doubles from coordinates, so graded axes are true to scale
// and 10^9 cells are placed exactly.
import { type Axis, FRAMES } from "../../base/axis";
import type { AxisIndex } from "../../base/grid";
import type { Extent } from "../../tiles/place";

export class Camera {
  readonly across: Axis;
  readonly up: Axis;
  // Coordinates in the middle of the view.
  private readonly u: number;
  private readonly v: number;

  constructor(
    readonly axis: AxisIndex,
    axes: readonly [Axis, Axis, Axis],
    readonly width: number, // CSS pixels
    readonly height: number,
    readonly ratio: number, // device pixels per CSS pixel
    centre: readonly [number, number, number],
    readonly zoom: number, // CSS pixels per unit of length
  ) {
    const frame = FRAMES[axis];
    this.across = axes[frame.u];
    this.up = axes[frame.v];
    this.u = centre[frame.u];
    this.v = centre[frame.v];
  }

  x_of(u: number): number {
    return this.width / 2 + (u - this.u) * this.zoom;
  }
  y_of(v: number): number {
    return this.height / 2 - (v - this.v) * this.zoom;
  }
  u_at(x: number): number {
    return this.u + (x - this.width / 2) / this.zoom;
  }
  v_at(y: number): number {
    return this.v - (y - this.height / 2) / this.zoom;
  }

  // Where a rectangle of cells lies.
  place_of({ u0, u1, v0, v1 }: Extent): { left: number; right: number; top: number; bottom: number } {
    const { across, up } = this;
    return { left: this.x_of(across.plane(u0)), right: this.x_of(across.plane(u1)), top: this.y_of(up.plane(v1)), bottom: this.y_of(up.plane(v0)) };
  }

  // The cells in sight.
  seen(): Extent {
    const part = (axis: Axis, low: number, high: number) => [Math.max(axis.cell_at(low), 0), Math.min(axis.cell_at(high) + 1, axis.cells)] as const;
    // To the end of the last device pixel, part of which may be cut off.
    const end = (size: number) => Math.ceil(size * this.ratio) / this.ratio;
    const [u0, u1] = part(this.across, this.u_at(0), this.u_at(end(this.width)));
    const [v0, v1] = part(this.up, this.v_at(end(this.height)), this.v_at(0));
    return { u0, u1, v0, v1 };
  }
}

// The cell of level 0 at each column and row of samples; -1 outside the grid. A device pixel has `each` x `each`
// samples.
export interface SampleCells {
  readonly columns: Int32Array; // ascending where not -1
  readonly rows: Int32Array; // descending where not -1
  readonly each: 1 | 2;
}

export function sample_cells(camera: Camera, each: 1 | 2): SampleCells {
  const samples = each * camera.ratio; // per CSS pixel
  const [width, height] = [Math.round(camera.width * camera.ratio) * each, Math.round(camera.height * camera.ratio) * each];
  return {
    columns: Int32Array.from({ length: width }, (_, i) => camera.across.cell_among(camera.u_at(i / samples), camera.u_at((i + 1) / samples))),
    rows: Int32Array.from({ length: height }, (_, i) => camera.up.cell_among(camera.v_at((i + 1) / samples), camera.v_at(i / samples))),
    each,
  };
}

// The new middle of a view when the zoom changes and the point under (x, y) stays where it is. It may lie outside
// the grid.
export function zoomed_about(camera: Camera, x: number, y: number, zoom: number): [number, number] {
  const u = camera.u_at(x) - (x - camera.width / 2) / zoom;
  const v = camera.v_at(y) + (y - camera.height / 2) / zoom;
  return [u, v];
}
