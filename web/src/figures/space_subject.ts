// The view in three dimensions as the subject of a figure: what the page shows, in any size.
import { type Part, parts_of } from "../base/picture_parts";
import { get_patiently } from "../server/api";
import type { Viewer } from "../state/viewer";
import { type Orbit, projection_of, reach, straight } from "../overview/space/camera";
import { type Colored, compose } from "../overview/sight/compose";
import { layers_of, palette_of } from "../overview/sight/layers";
import { PART, camera_query, cut_of, fetch_layers, sight_of } from "../overview/sight/query";
import { space_of } from "../overview/space/space";
import { Viewpoint } from "../overview/space/viewpoint";
import type { FigureOptions } from "./options";
import { box_share, draw_coordinates, draw_edges } from "./space_box";
import type { Picture, Subject } from "./subject";

const ROUGHLY = 400; // pixels in which the content is looked for
const [MOST, LONGEST] = [2 ** 26, 2 ** 14]; // pixels of a whole picture of which the server shows parts, and of its sides
const MARGIN = 0.01; // around the content, as a share of the whole width
const FARTHEST = 0.3; // of the view, beyond its borders: so far a figure shows the domain with the view
const ROOM = { across: 44, above: 8, below: 28, bar: 20 }; // points beside the domain, for coordinates, and below these for a scale bar

// The shape of the view on the page.
function panel_aspect(): number {
  const panel = document.querySelector(".view-overview")?.getBoundingClientRect();
  return panel && panel.width > 8 && panel.height > 8 ? panel.width / panel.height : 4 / 3;
}

// A part of the picture with the given size.
async function fetch_part(viewer: Viewer, orbit: Orbit, width: number, height: number, part: Part, signal: AbortSignal): Promise<Colored> {
  const space = space_of(viewer.axes);
  const sight = sight_of(viewer);
  const query = `${camera_query(viewer, space, orbit, width, height)}${cut_of(viewer)}&window=${part.x0},${part.y0},${part.x1},${part.y1}`;
  const sights = await fetch_layers(viewer, space, layers_of(sight), query, (address) => get_patiently(address, signal));
  return compose(sights, palette_of(sight));
}

// Where something is seen, as shares of the picture.
async function content_of(viewer: Viewer, orbit: Orbit, aspect: number, signal: AbortSignal): Promise<Part | null> {
  const [width, height] = [ROUGHLY, Math.max(1, Math.round(ROUGHLY / aspect))];
  const { label } = await fetch_part(viewer, orbit, width, height, { x0: 0, y0: 0, x1: width, y1: height }, signal);
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

// Premultiplied pixels as an image has them.
function image_of(part: Colored): ImageData {
  const out = new ImageData(part.width, part.height);
  for (let i = 0; i < out.data.length; i += 4) {
    const alpha = part.pixels[i + 3]!;
    for (let c = 0; c < 3; ++c) out.data[i + c] = alpha === 0 ? 0 : (255 * part.pixels[i + c]!) / alpha;
    out.data[i + 3] = alpha;
  }
  return out;
}

const around = (a: Part, b: Part): Part => ({ x0: Math.min(a.x0, b.x0), y0: Math.min(a.y0, b.y0), x1: Math.max(a.x1, b.x1), y1: Math.max(a.y1, b.y1) });

export interface SpaceWish {
  readonly crop: FigureOptions["crop"];
  readonly axes: boolean; // the domain with coordinates
  readonly bar: boolean; // a scale bar
  readonly points: number; // the figure's width
  readonly ink: string;
  readonly along?: 0 | 1 | 2; // seen from the upper end of an axis, in place of where the page looks from
}

export async function space_subject(viewer: Viewer, { crop, axes, bar, points, ink, along }: SpaceWish, signal: AbortSignal): Promise<Subject> {
  const space = space_of(viewer.axes);
  const aspect = panel_aspect();
  const viewpoint = new Viewpoint(viewer, space, aspect);
  const { azimuth, elevation } = straight(along ?? 0, true, viewer.sky.peek());
  const orbit = along === undefined ? viewpoint.orbit : viewpoint.home(azimuth, elevation);
  const seen = crop === "content" ? await content_of(viewer, orbit, aspect, signal) : null;
  let page: Part = seen ?? { x0: 0, y0: 0, x1: 1, y1: 1 }; // what the figure shows of the view, as shares of that
  const box = axes && crop !== "screen" ? box_share(projection_of(orbit, 1000 * aspect, 1000), space.half) : null;
  // A view that is far within its domain stays as it is.
  if (box && Math.min(box.x0, box.y0) > -FARTHEST && Math.max(box.x1, box.y1) < 1 + FARTHEST) {
    page = seen ? around(seen, box) : around(page, box);
    const per_share = Math.max(points - 2 * ROOM.across, points / 4) / (page.x1 - page.x0);
    const [dx, below] = [ROOM.across / per_share, ROOM.below + (bar ? ROOM.bar : 0)];
    page = { x0: page.x0 - dx, y0: page.y0 - (ROOM.above * aspect) / per_share, x1: page.x1 + dx, y1: page.y1 + (below * aspect) / per_share };
  }
  const [across, up] = [page.x1 - page.x0, page.y1 - page.y0];
  const part = { x0: Math.max(page.x0, 0), y0: Math.max(page.y0, 0), x1: Math.min(page.x1, 1), y1: Math.min(page.y1, 1) }; // of it, what has pixels
  const whole_length = (2 * reach(aspect).x * orbit.distance) / space.scale;
  return {
    aspect: up / aspect / across,
    axes: null,
    planes: null,
    length: whole_length * across,
    async fetch(pixels, _, abort): Promise<Picture> {
      const wanted = pixels / across;
      const fewer = Math.min(1, Math.sqrt((MOST * aspect) / (wanted * wanted)), LONGEST / wanted, (LONGEST * aspect) / wanted);
      const [width, height] = [Math.max(1, Math.floor(wanted * fewer)), Math.max(1, Math.floor((wanted * fewer) / aspect))];
      const [x0, y0] = [Math.round(part.x0 * width), Math.round(part.y0 * height)];
      const [x1, y1] = [Math.max(x0 + 1, Math.round(part.x1 * width)), Math.max(y0 + 1, Math.round(part.y1 * height))];
      const picture = new OffscreenCanvas(x1 - x0, y1 - y0);
      const labels = new Set<number>();
      const context = picture.getContext("2d")!;
      for (const p of parts_of(picture.width, picture.height, PART)) {
        const came = await fetch_part(viewer, orbit, width, height, { x0: x0 + p.x0, y0: y0 + p.y0, x1: x0 + p.x1, y1: y0 + p.y1 }, abort);
        for (const label of came.label) if (label > 0) labels.add(label - 1);
        context.putImageData(image_of(came), p.x0, p.y0);
      }
      return {
        labels: [...labels].sort((a, b) => a - b),
        note: fewer < 1 ? `Drawn with ${picture.width} pixels, the most that are made, and enlarged.` : "Cells of at most a quarter of a pixel.",
        paint: (sheet, { plot }, taken) => {
          const w = plot.width / across; // of the whole view
          const h = w / aspect;
          const placing = { view: projection_of(orbit, w, h), x: plot.x - page.x0 * w, y: plot.y - page.y0 * h };
          const { context } = sheet;
          context.save();
          context.beginPath();
          context.rect(plot.x, plot.y, plot.width, plot.height);
          context.clip();
          if (axes) draw_edges(sheet, placing, space, ink, true);
          context.drawImage(picture, placing.x + (x0 / width) * w, placing.y + (y0 / height) * h, (picture.width / width) * w, (picture.height / height) * h);
          if (axes) {
            draw_edges(sheet, placing, space, ink, false);
            draw_coordinates(sheet, placing, viewer, space, ink, taken);
          }
          context.restore();
        },
      };
    },
  };
}
