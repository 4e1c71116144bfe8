// The view in three dimensions as the subject of a figure: what the page shows, in any size.
import { type Part, parts_of } from "../base/picture_parts";
import { get_patiently } from "../server/api";
import type { Viewer } from "../state/viewer";
import type { Rgb } from "../tiles/sets";
import { reach } from "../overview/space/camera";
import { type Colored, compose } from "../overview/sight/compose";
import { layers_of, palette_of } from "../overview/sight/layers";
import { PART, camera_query, cut_of, fetch_layers, sight_of } from "../overview/sight/query";
import { space_of } from "../overview/space/space";
import { Viewpoint } from "../overview/space/viewpoint";
import type { FigureOptions } from "./options";
import type { Picture, Subject } from "./subject";

const ROUGHLY = 400; // pixels in which the content is looked for
const [MOST, LONGEST] = [2 ** 26, 2 ** 14]; // pixels of a whole picture of which the server shows parts, and of its sides
const MARGIN = 0.01; // around the content, as a share of the whole width

// The shape of the view on the page.
function panel_aspect(): number {
  const panel = document.querySelector(".view-overview")?.getBoundingClientRect();
  return panel && panel.width > 8 && panel.height > 8 ? panel.width / panel.height : 4 / 3;
}

// A part of the picture with the given size.
async function fetch_part(viewer: Viewer, width: number, height: number, part: Part, signal: AbortSignal): Promise<Colored> {
  const space = space_of(viewer.axes);
  const viewpoint = new Viewpoint(viewer, space, panel_aspect());
  const sight = sight_of(viewer);
  const query = `${camera_query(viewer, space, viewpoint.orbit, width, height)}${cut_of(viewer)}&window=${part.x0},${part.y0},${part.x1},${part.y1}`;
  const sights = await fetch_layers(viewer, space, layers_of(sight), query, (address) => get_patiently(address, signal));
  return compose(sights, palette_of(sight));
}

// Where something is seen, as shares of the picture.
async function content_of(viewer: Viewer, aspect: number, signal: AbortSignal): Promise<Part | null> {
  const [width, height] = [ROUGHLY, Math.max(1, Math.round(ROUGHLY / aspect))];
  const { label } = await fetch_part(viewer, width, height, { x0: 0, y0: 0, x1: width, y1: height }, signal);
  let [x0, y0, x1, y1] = [width, height, 0, 0];
  label.forEach((seen, i) => {
    if (seen === 0) return;
    const [x, y] = [i % width, Math.floor(i / width)];
    [x0, y0, x1, y1] = [Math.min(x0, x), Math.min(y0, y), Math.max(x1, x + 1), Math.max(y1, y + 1)];
  });
  if (x0 >= x1) return null;
  const share = (x: number, all: number, by: number) => Math.min(Math.max(x / all + by, 0), 1);
  return { x0: share(x0, width, -MARGIN), y0: share(y0, height, -MARGIN), x1: share(x1, width, MARGIN), y1: share(y1, height, MARGIN) };
}

// Premultiplied pixels over a ground, as an image has them.
function laid_over(part: Colored, ground: Rgb | null): ImageData {
  const out = new ImageData(part.width, part.height);
  for (let i = 0; i < out.data.length; i += 4) {
    const alpha = part.pixels[i + 3]!;
    for (let c = 0; c < 3; ++c) {
      const own = part.pixels[i + c]!;
      out.data[i + c] = ground ? own + (ground[c]! * (255 - alpha)) / 255 : alpha === 0 ? 0 : (255 * own) / alpha;
    }
    out.data[i + 3] = ground ? 255 : alpha;
  }
  return out;
}

export async function space_subject(viewer: Viewer, options: FigureOptions, ground: Rgb | null, signal: AbortSignal): Promise<Subject> {
  const aspect = panel_aspect();
  const content = options.crop === "content" ? await content_of(viewer, aspect, signal) : null;
  const part = content ?? { x0: 0, y0: 0, x1: 1, y1: 1 };
  const space = space_of(viewer.axes);
  const viewpoint = new Viewpoint(viewer, space, aspect);
  const whole_length = (2 * reach(aspect).x * viewpoint.orbit.distance) / space.scale;
  return {
    aspect: (part.y1 - part.y0) / aspect / (part.x1 - part.x0),
    axes: null,
    planes: null,
    length: whole_length * (part.x1 - part.x0),
    async fetch(pixels, _, abort): Promise<Picture> {
      const wanted = pixels / (part.x1 - part.x0);
      const fewer = Math.min(1, Math.sqrt((MOST * aspect) / (wanted * wanted)), LONGEST / wanted, (LONGEST * aspect) / wanted);
      const [width, height] = [Math.floor(wanted * fewer), Math.floor((wanted * fewer) / aspect)];
      const [x0, y0] = [Math.round(part.x0 * width), Math.round(part.y0 * height)];
      const [x1, y1] = [Math.max(x0 + 1, Math.round(part.x1 * width)), Math.max(y0 + 1, Math.round(part.y1 * height))];
      const image = new ImageData(x1 - x0, y1 - y0);
      const labels = new Set<number>();
      const picture = new OffscreenCanvas(image.width, image.height);
      const context = picture.getContext("2d")!;
      for (const p of parts_of(image.width, image.height, PART)) {
        const came = await fetch_part(viewer, width, height, { x0: x0 + p.x0, y0: y0 + p.y0, x1: x0 + p.x1, y1: y0 + p.y1 }, abort);
        for (const label of came.label) if (label > 0) labels.add(label - 1);
        context.putImageData(laid_over(came, ground), p.x0, p.y0);
      }
      return {
        labels: [...labels].sort((a, b) => a - b),
        note: fewer < 1 ? `Drawn with ${image.width} pixels, the most that are made, and enlarged.` : "Cells of at most a quarter of a pixel.",
        paint: (sheet, { plot }) => sheet.context.drawImage(picture, plot.x, plot.y, plot.width, plot.height),
      };
    },
  };
}
