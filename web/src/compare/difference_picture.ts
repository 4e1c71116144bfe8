// What differs, painted over the picture on the left.
import type { AxisIndex } from "../base/grid";
import { sample_cells } from "../views/camera";
import { SetComparison, compare_pictures } from "../views/differences";
import { samples_for } from "../views/view";
import type { Pair } from "./pair";

// Paints whenever a picture has changed. Returns a function that ends it.
export function show_differences({ left, right, frames }: Pair, axis: AxisIndex): () => void {
  const canvas = document.createElement("canvas");
  canvas.className = "view-cells view-differences";
  const context = canvas.getContext("2d")!;
  const [a, b] = [left.views[axis], right.views[axis]];
  const comparison = new SetComparison(
    { materials: left.viewer.info.materials, sets: left.sets },
    { materials: right.viewer.info.materials, sets: right.sets },
  );
  let key = "";
  const draw = () => {
    if (left.changing || right.changing || !a.camera || !b.camera || !a.cells.isConnected) return; // another frame is to come
    if (a.width !== b.width || a.height !== b.height) return; // so is another size
    const ratio = Math.min(a.camera.ratio, b.camera.ratio);
    const now = `${a.picture_key} | ${b.picture_key} | ${ratio}`;
    const ink = left.scene(ratio)?.ink;
    if (now === key || !ink) return;
    key = now;
    const cameras = [a.camera_of(left.viewer, ratio), b.camera_of(right.viewer, ratio)] as const;
    const each = Math.max(...cameras.map(samples_for)) as 1 | 2;
    const [x, y] = cameras.map((camera) => sample_cells(camera, each)) as [ReturnType<typeof sample_cells>, ReturnType<typeof sample_cells>];
    const verdicts = compare_pictures({ samples: x, regions: a.shown.regions }, { samples: y, regions: b.shown.regions }, comparison);
    const [width, height] = [x.columns.length / each, x.rows.length / each];
    [canvas.width, canvas.height] = [width, height];
    const picture = new ImageData(width, height);
    const pixels = new Uint32Array(picture.data.buffer);
    verdicts.forEach((verdict, i) => (pixels[i] = ink.differences[verdict]!));
    context.putImageData(picture, 0, 0);
    if (!canvas.isConnected) a.cells.after(canvas);
  };
  const stop = frames.subscribe(draw);
  return () => {
    stop();
    canvas.remove();
  };
}
