// The domain seen from the upper end of an axis, as the subject of a figure. There is no perspective: a length is as long everywhere, so there are
// coordinates beside the picture, and a scale bar, as there are with slices.
import { AXIS_NAMES, type AxisIndex } from "../base/grid";
import { straight_query } from "../overview/sight/query";
import { space_of } from "../overview/space/space";
import type { Viewer } from "../state/viewer";
import type { FigureOptions } from "./options";
import { type Look, content_of, fetch_picture, makeable, note_of } from "./sight_picture";
import { page_view } from "./space_subject";
import type { Picture, Subject } from "./subject";

const ROUGHLY = 1000; // pixels in which the content is looked for
const MARGIN = 0.03; // around the content, as a share of its longer side, as far as the domain reaches

// Which axis is up, which one lies across, and whether that one falls towards the right. As the server has it (server/render/camera.hpp).
export function straight_frame(axis: AxisIndex, sky: AxisIndex): { across: AxisIndex; up: AxisIndex; falls: boolean } {
  const up = axis !== sky ? sky : axis === 2 ? 1 : 2;
  return { across: (3 - axis - up) as AxisIndex, up, falls: (up + 1) % 3 !== axis };
}

export async function straight_subject(viewer: Viewer, axis: AxisIndex, crop: FigureOptions["crop"], signal: AbortSignal): Promise<Subject> {
  const space = space_of(viewer.axes);
  const { orbit } = page_view(viewer, space);
  const look: Look = { perspective: false, query: (width, height) => straight_query(viewer, space, axis, orbit, width, height) };
  const { across: u, up: v, falls } = straight_frame(axis, orbit.sky);
  const [across, up] = [viewer.axes[u], viewer.axes[v]];
  const [wide, high] = [across.max - across.min, up.max - up.min];
  // A picture of the whole domain, which fills its width, and lies in the middle of its height. Lengths are from the domain's upper left corner.
  const picture_of = (wanted: number) => {
    const fewer = makeable(wanted, (wanted * high) / wide);
    const width = Math.max(1, Math.floor(wanted * fewer));
    const pixel = wide / width;
    const height = Math.max(1, Math.ceil(high / pixel - 1e-6));
    return { fewer, width, height, pixel, above: (height * pixel - high) / 2 };
  };
  let [x0, y0, x1, y1] = [0, 0, wide, high];
  if (crop === "content") {
    const { width, height, pixel, above } = picture_of(ROUGHLY * Math.min(1, wide / high));
    const seen = await content_of(viewer, look, width, height, signal);
    if (seen) {
      const margin = MARGIN * pixel * Math.max(seen.x1 - seen.x0, seen.y1 - seen.y0);
      [x0, x1] = [Math.max(0, seen.x0 * pixel - margin), Math.min(wide, seen.x1 * pixel + margin)];
      [y0, y1] = [Math.max(0, seen.y0 * pixel - above - margin), Math.min(high, seen.y1 * pixel - above + margin)];
    }
  }
  const length = x1 - x0;
  const x_of = (x: number) => (falls ? across.max - x : across.min + x);
  return {
    aspect: (y1 - y0) / length,
    axes: [
      { name: `${AXIS_NAMES[u]} [${viewer.units}]`, low: x_of(x0), high: x_of(x1) },
      { name: `${AXIS_NAMES[v]} [${viewer.units}]`, low: up.max - y1, high: up.max - y0 },
    ],
    planes: null,
    length,
    async fetch(pixels, _, abort): Promise<Picture> {
      const { fewer, width, height, pixel, above } = picture_of((pixels * wide) / length);
      const inside = (at: number, all: number) => Math.min(Math.max(at, 0), all);
      const part = {
        x0: inside(Math.floor(x0 / pixel), width - 1),
        y0: inside(Math.floor((y0 + above) / pixel), height - 1),
        x1: inside(Math.ceil(x1 / pixel), width),
        y1: inside(Math.ceil((y1 + above) / pixel), height),
      };
      const { picture, labels } = await fetch_picture(viewer, look, width, height, part, abort);
      return {
        labels,
        note: note_of(fewer, picture.width),
        paint: ({ context }, { plot }) => {
          const zoom = plot.width / length; // points per length
          const side = pixel * zoom;
          context.save();
          context.beginPath();
          context.rect(plot.x, plot.y, plot.width, plot.height);
          context.clip();
          context.drawImage(picture, plot.x + part.x0 * side - x0 * zoom, plot.y + part.y0 * side - (y0 + above) * zoom, picture.width * side, picture.height * side);
          context.restore();
        },
      };
    },
  };
}
