// The view in three dimensions as the subject of a figure: what the page shows, in any size.
import type { Part } from "../base/picture_parts";
import { type Orbit, projection_of } from "../overview/space/camera";
import { camera_query, cut_of } from "../overview/sight/query";
import { type Space, space_of } from "../overview/space/space";
import { Viewpoint } from "../overview/space/viewpoint";
import type { Viewer } from "../state/viewer";
import type { FigureOptions } from "./options";
import { type Look, content_of, fetch_picture, makeable, note_of } from "./sight_picture";
import { box_share, draw_coordinates, draw_edges } from "./space_box";
import type { Picture, Subject } from "./subject";

const ROUGHLY = 400; // pixels in which the content is looked for
const MARGIN = 0.01; // around the content, as a share of the whole width
const FARTHEST = 0.3; // of the view, beyond its borders: so far a figure shows the domain with the view
const ROOM = { across: 50, above: 8, below: 28 }; // points beside the domain, for coordinates

// Where the page looks from, and the shape of its view.
export function page_view(viewer: Viewer, space: Space): { orbit: Orbit; aspect: number } {
  const panel = document.querySelector(".view-overview")?.getBoundingClientRect();
  const aspect = panel && panel.width > 8 && panel.height > 8 ? panel.width / panel.height : 4 / 3;
  return { orbit: new Viewpoint(viewer, space, aspect).orbit, aspect };
}

// Where something is seen, as shares of the picture.
async function content_shares(viewer: Viewer, look: Look, aspect: number, signal: AbortSignal): Promise<Part | null> {
  const [width, height] = [ROUGHLY, Math.max(1, Math.round(ROUGHLY / aspect))];
  const seen = await content_of(viewer, look, width, height, signal);
  const share = (x: number, all: number, by: number) => Math.min(Math.max(x / all + by, 0), 1);
  return seen && { x0: share(seen.x0, width, -MARGIN), y0: share(seen.y0, height, -MARGIN), x1: share(seen.x1, width, MARGIN), y1: share(seen.y1, height, MARGIN) };
}

const around = (a: Part, b: Part): Part => ({ x0: Math.min(a.x0, b.x0), y0: Math.min(a.y0, b.y0), x1: Math.max(a.x1, b.x1), y1: Math.max(a.y1, b.y1) });

export interface SpaceWish {
  readonly crop: FigureOptions["crop"];
  readonly axes: boolean; // the domain with coordinates
  readonly points: number; // the figure's width
  readonly ink: string;
}

export async function space_subject(viewer: Viewer, { crop, axes, points, ink }: SpaceWish, signal: AbortSignal): Promise<Subject> {
  const space = space_of(viewer.axes);
  const { orbit, aspect } = page_view(viewer, space);
  const look: Look = { perspective: true, query: (width, height) => camera_query(viewer, space, orbit, width, height) + cut_of(viewer) };
  const seen = crop === "content" ? await content_shares(viewer, look, aspect, signal) : null;
  let page: Part = seen ?? { x0: 0, y0: 0, x1: 1, y1: 1 }; // what the figure shows of the view, as shares of that
  const box = axes && crop !== "screen" ? box_share(projection_of(orbit, 1000 * aspect, 1000), space.half) : null;
  // A view that is far within its domain stays as it is.
  if (box && Math.min(box.x0, box.y0) > -FARTHEST && Math.max(box.x1, box.y1) < 1 + FARTHEST) {
    page = seen ? around(seen, box) : around(page, box);
    const per_share = Math.max(points - 2 * ROOM.across, points / 4) / (page.x1 - page.x0);
    const dx = ROOM.across / per_share;
    page = { x0: page.x0 - dx, y0: page.y0 - (ROOM.above * aspect) / per_share, x1: page.x1 + dx, y1: page.y1 + (ROOM.below * aspect) / per_share };
  }
  const [across, up] = [page.x1 - page.x0, page.y1 - page.y0];
  const part = { x0: Math.max(page.x0, 0), y0: Math.max(page.y0, 0), x1: Math.min(page.x1, 1), y1: Math.min(page.y1, 1) }; // of it, what has pixels
  return {
    aspect: up / aspect / across,
    axes: null,
    planes: null,
    length: null, // a scale bar would hold at one distance alone
    async fetch(pixels, _, abort): Promise<Picture> {
      const wanted = pixels / across;
      const fewer = makeable(wanted, wanted / aspect);
      const [width, height] = [Math.max(1, Math.floor(wanted * fewer)), Math.max(1, Math.floor((wanted * fewer) / aspect))];
      const [x0, y0] = [Math.round(part.x0 * width), Math.round(part.y0 * height)];
      const [x1, y1] = [Math.max(x0 + 1, Math.round(part.x1 * width)), Math.max(y0 + 1, Math.round(part.y1 * height))];
      const { picture, labels } = await fetch_picture(viewer, look, width, height, { x0, y0, x1, y1 }, abort);
      return {
        labels,
        note: note_of(fewer, picture.width),
        paint: (sheet, { plot }) => {
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
            draw_coordinates(sheet, placing, viewer, space, ink);
          }
          context.restore();
        },
      };
    },
  };
}
