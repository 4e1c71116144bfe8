// The picture of a slice on the start page. It is true to scale: as wide and high as the domain, with graded axes
// stretched cell by cell.
import type { Signal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { type Axis, FRAMES } from "../base/axis";
import { AXIS_NAMES, type AxisIndex, type GridSummary } from "../base/grid";
import { picture_at } from "../server/picture";
import { NoPicture } from "./no_picture";

const PICTURE = 360; // cells: the level is about as fine as the picture on the card
const MARGIN = 8;

// The size in pixels of a picture that fits into this width and height.
export function fitted(u: Axis, v: Axis, width: number, height: number): [number, number] {
  const [along_u, along_v] = [u.max - u.min, v.max - v.min];
  const scale = Math.min(width / along_u, height / along_v);
  return [Math.max(1, Math.round(scale * along_u)), Math.max(1, Math.round(scale * along_v))];
}

// The cell of the level under the middle of each pixel across an axis.
export function cells_under(axis: Axis, level: number, pixels: number): number[] {
  const step = (axis.max - axis.min) / pixels;
  return Array.from({ length: pixels }, (_, p) => Math.floor(axis.clamp(axis.cell_at(axis.min + (p + 0.5) * step)) / 2 ** level));
}

function pixels_of(picture: ImageBitmap): Uint32Array {
  const context = new OffscreenCanvas(picture.width, picture.height).getContext("2d")!;
  context.drawImage(picture, 0, 0);
  return new Uint32Array(context.getImageData(0, 0, picture.width, picture.height).data.buffer);
}

function draw_graded(context: CanvasRenderingContext2D, picture: ImageBitmap, u: Axis, v: Axis, level: number): void {
  const { width, height } = context.canvas;
  const from = pixels_of(picture);
  const columns = cells_under(u, level, width);
  const rows = cells_under(v, level, height).reverse(); // v points up
  const out = new ImageData(width, height);
  const pixels = new Uint32Array(out.data.buffer);
  rows.forEach((row, y) => columns.forEach((column, x) => (pixels[y * width + x] = from[(picture.height - 1 - row) * picture.width + column]!)));
  context.putImageData(out, 0, 0);
}

function draw_uniform(context: CanvasRenderingContext2D, picture: ImageBitmap, u: Axis, v: Axis, level: number): void {
  const { width, height } = context.canvas;
  const [across, up] = [u.cells / 2 ** level, v.cells / 2 ** level]; // the last cells may reach past the end
  context.imageSmoothingEnabled = width < across; // cells stay sharp when they are larger than pixels
  context.imageSmoothingQuality = "high";
  context.drawImage(picture, 0, picture.height - up, across, up, 0, 0, width, height);
}

function show(canvas: HTMLCanvasElement, picture: ImageBitmap, u: Axis, v: Axis, level: number): void {
  const { clientWidth, clientHeight } = canvas.parentElement!;
  [canvas.width, canvas.height] = fitted(u, v, devicePixelRatio * (clientWidth - 2 * MARGIN), devicePixelRatio * (clientHeight - 2 * MARGIN));
  canvas.style.width = `${canvas.width / devicePixelRatio}px`;
  (u.graded || v.graded ? draw_graded : draw_uniform)(canvas.getContext("2d")!, picture, u, v, level);
}

// Pictures are fetched like everything else, so that the token goes along.
interface Props {
  readonly grid: GridSummary;
  readonly axes: readonly Axis[];
  readonly axis: AxisIndex;
  readonly damage: Signal<string | null>;
}
export function Preview({ grid, axes, axis, damage }: Props) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [there, set_there] = useState(false);
  const [error, set_error] = useState<unknown>(null);
  const frame = FRAMES[axis];
  const [u, v] = [axes[frame.u]!, axes[frame.v]!];
  let level = 0;
  while (Math.max(u.cells, v.cells) / 2 ** level > PICTURE) ++level;
  const index = Math.floor(grid.cells[axis] / 2 / 2 ** level);
  const path = `api/v1/grids/${encodeURIComponent(grid.id)}/slice/${AXIS_NAMES[axis]}/${index}.png?level=${level}&v=${grid.hash}`;
  useEffect(() => {
    const abort = new AbortController();
    picture_at(path, abort.signal)
      .then(createImageBitmap)
      .then((picture) => {
        if (abort.signal.aborted) return;
        show(canvas.current!, picture, u, v, level);
        set_there(true);
      })
      .catch((problem: unknown) => abort.signal.aborted || set_error(problem));
    return () => abort.abort();
  }, [path]);
  return (
    <span class="preview">
      <canvas ref={canvas} role="img" aria-label={`${grid.id}: slice across ${AXIS_NAMES[axis]} in the middle`} hidden={!there} />
      {error !== null && <NoPicture error={error} damage={damage} />}
    </span>
  );
}
