// What differs, painted over the picture on the left.
import type { Signal } from "@preact/signals";
import { slices_meet } from "../state/comparison";
import type { Comparison } from "../state/viewer";
import { sample_cells } from "../views/drawing/camera";
import { SetComparison, compare_pictures } from "../views/drawing/differences";
import { samples_for } from "../views/view";
import type { Pair } from "./pair";

// Paints whenever a picture has changed. Returns a function that ends it.
export function show_differences({ left, right, frames }: Pair, comparison: Signal<Comparison>): () => void {
  const { axis } = comparison.peek();
  const canvas = document.createElement("canvas");
  canvas.className = "view-cells view-differences";
  const context = canvas.getContext("2d")!;
  const [a, b] = [left.views[axis], right.views[axis]];
  const sets = new SetComparison(
    { names: left.viewer.material_names, background: left.viewer.info.materials[0]!.name, sets: left.sets },
    { names: right.viewer.material_names, background: right.viewer.info.materials[0]!.name, sets: right.sets },
  );
  let key = "";
  let picture = new ImageData(1, 1);
  const draw = () => {
    if (left.changing || right.changing || !a.visible || !a.camera || !b.camera || !a.cells.isConnected) return; // another frame is to come
    if (a.width !== b.width || a.height !== b.height) return; // so is another size
    // Other slices may be shown for a moment, or where one grid ends.
    canvas.hidden = a.shown.stale || b.shown.stale || !slices_meet(left.viewer, right.viewer, comparison.peek());
    const ratio = Math.min(a.camera.ratio, b.camera.ratio);
    const now = `${a.picture_key} | ${b.picture_key} | ${ratio}`;
    const ink = left.scene(ratio)?.ink;
    if (now === key || !ink) return;
    key = now;
    const cameras = [a.camera_of(left.viewer, ratio), b.camera_of(right.viewer, ratio)] as const;
    const each = Math.max(...cameras.map(samples_for)) as 1 | 2;
    const [x, y] = [sample_cells(cameras[0], each), sample_cells(cameras[1], each)];
    const verdicts = compare_pictures({ samples: x, regions: a.shown.regions }, { samples: y, regions: b.shown.regions }, sets);
    const [width, height] = [x.columns.length / each, x.rows.length / each];
    if (picture.width !== width || picture.height !== height) {
      picture = new ImageData(width, height);
      [canvas.width, canvas.height] = [width, height];
    }
    const pixels = new Uint32Array(picture.data.buffer);
    for (let i = 0; i < pixels.length; ++i) pixels[i] = ink.differences[verdicts[i]!]!;
    context.putImageData(picture, 0, 0);
    if (!canvas.isConnected) a.cells.after(canvas);
  };
  const stop = frames.subscribe(draw);
  return () => {
    stop();
    canvas.remove();
  };
}
