// The cells of a part of a slice, as fine as a picture of a given width can show them, whatever is on the screen.
import { type Axis, FRAMES } from "../base/axis";
import { type AxisIndex, without_overlap } from "../base/grid";
import type { LabelLook } from "../base/materials";
import { get_patiently } from "../server/api";
import type { Viewer } from "../state/viewer";
import { cover } from "../tiles/cover";
import { type Extent, TILE, extent_of, tile_size } from "../tiles/place";
import type { Region } from "../tiles/regions";
import { type Palette, type Rgb, SetTable } from "../tiles/sets";
import { decode_tile } from "../tiles/tile";
import { Camera, type SampleCells } from "../views/drawing/camera";
import { paint } from "../views/drawing/paint";
import { samples_of } from "../views/view";

export type Window = Readonly<Extent>; // coordinates

export interface SliceCells {
  readonly camera: Camera;
  readonly samples: SampleCells;
  readonly regions: readonly Region[];
  readonly sets: SetTable;
  readonly level: number; // the coarsest one
}

const AT_ONCE = 4; // requests

export const whole_window = (across: Axis, up: Axis): Window => ({ u0: across.min, u1: across.max, v0: up.min, v1: up.max });

// `width`: of the picture, in pixels. Its height follows, since the picture is true to scale.
export async function fetch_cells(viewer: Viewer, axis: AxisIndex, window: Window, width: number, signal: AbortSignal): Promise<SliceCells> {
  const zoom = width / (window.u1 - window.u0);
  const height = Math.max(1, Math.round((window.v1 - window.v0) * zoom));
  const centre: [number, number, number] = [0, 0, 0];
  centre[FRAMES[axis].u] = (window.u0 + window.u1) / 2;
  centre[FRAMES[axis].v] = (window.v0 + window.v1) / 2;
  const camera = new Camera(axis, viewer.axes, width, height, 1, centre, zoom);
  const slice = viewer.cell.peek()[axis];
  const places = cover({ axis, slice, axes: viewer.axes, levels: viewer.info.levels.length, scale: zoom, seen: camera.seen() });
  const sets = new SetTable((label) => without_overlap(viewer.labels, label));
  const regions: Region[] = [];
  const waiting = places.entries();
  const take = async () => {
    for (const [n, place] of waiting) {
      const address = viewer.address.tile(axis, place.index, place.level, place.column, place.row, viewer.show_shares.peek());
      const bytes = await (await get_patiently(address, signal)).arrayBuffer();
      regions[n] = { ...extent_of(place, viewer.cells), tile: decode_tile(place, tile_size(place, viewer.cells), bytes, sets), damaged: false };
    }
  };
  await Promise.all(Array.from({ length: AT_ONCE }, take));
  return { camera, samples: samples_of(camera), regions, sets, level: Math.max(0, ...places.map((place) => place.level)) };
}

// Calls for each run of cells of one set along u: numbers of sets, and cells of level 0, clipped to `seen`.
export function for_each_run({ regions }: Pick<SliceCells, "regions">, seen: Extent, call: (set: number, run: Extent) => void): void {
  for (const { tile } of regions) {
    if (!tile) continue;
    const { level, column, row } = tile.place;
    const size = 2 ** level;
    const clip = (cell: number, from: number, to: number) => Math.min(Math.max(cell * size, from), to);
    for (let r = 0; r < tile.height; ++r) {
      const [v0, v1] = [clip(row * TILE + r, seen.v0, seen.v1), clip(row * TILE + r + 1, seen.v0, seen.v1)];
      if (v0 >= v1) continue;
      for (let c = 0; c < tile.width; ) {
        const label = tile.labels ? tile.labels[r * tile.width + c]! : 0;
        let end = tile.labels ? c + 1 : tile.width;
        while (end < tile.width && tile.labels![r * tile.width + end] === label) ++end;
        const [u0, u1] = [clip(column * TILE + c, seen.u0, seen.u1), clip(column * TILE + end, seen.u0, seen.u1)];
        if (u0 < u1) call(tile.sets[label]!, { u0, u1, v0, v1 });
        c = end;
      }
    }
  }
}

// The labels that occur in sight, ascending.
export function labels_in(cells: SliceCells): number[] {
  const found = new Set<number>();
  for_each_run(cells, cells.camera.seen(), (set) => found.add(set));
  return [...new Set([...found].flatMap((set) => cells.sets.members(set) ?? []))].sort((a, b) => a - b);
}

// The part of a slice that holds everything that is not clear; null when all of it is.
export function content_of(cells: SliceCells, looks: readonly LabelLook[]): Window | null {
  const { across, up } = cells.camera;
  const known = new Map<number, boolean>();
  const is_seen = (set: number): boolean => {
    const seen = known.get(set) ?? (cells.sets.members(set) ?? []).some((label) => looks[label]!.visible && looks[label]!.opacity > 0);
    known.set(set, seen);
    return seen;
  };
  const box: Extent = { u0: Infinity, u1: -Infinity, v0: Infinity, v1: -Infinity };
  for_each_run(cells, cells.camera.seen(), (set, run) => {
    if (!is_seen(set)) return;
    box.u0 = Math.min(box.u0, run.u0);
    box.u1 = Math.max(box.u1, run.u1);
    box.v0 = Math.min(box.v0, run.v0);
    box.v1 = Math.max(box.v1, run.v1);
  });
  return box.u0 < box.u1 ? { u0: across.plane(box.u0), u1: across.plane(box.u1), v0: up.plane(box.v0), v1: up.plane(box.v1) } : null;
}

// The pixels over a ground; null keeps what is clear clear. Rows from the top, RGBA, not premultiplied.
export function pixels_over(cells: SliceCells, palette: Palette, looks: readonly LabelLook[], ground: Rgb | null): ImageData {
  const { width, height } = cells.camera;
  const over = (color: Rgb): ImageData => {
    const image = new ImageData(width, height);
    palette.update(looks, color, color);
    paint(new Uint32Array(image.data.buffer), cells.samples, cells.regions, palette.colors);
    return image;
  };
  if (ground) return over(ground);
  const [black, white] = [over([0, 0, 0]).data, over([255, 255, 255])];
  uncover(black, white.data);
  return white;
}

// Of the same picture over black and over white, makes the one over nothing: white - black is what the ground adds.
export function uncover(black: Uint8ClampedArray, white: Uint8ClampedArray): void {
  for (let i = 0; i < white.length; i += 4) {
    const through = Math.max(white[i]! - black[i]!, white[i + 1]! - black[i + 1]!, white[i + 2]! - black[i + 2]!);
    const alpha = 255 - Math.max(through, 0);
    for (let c = i; c < i + 3; ++c) white[c] = alpha === 0 ? 0 : (255 * black[c]!) / alpha;
    white[i + 3] = alpha;
  }
}
