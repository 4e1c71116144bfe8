// The domain's edges as rulers. They show the coordinates of their ends. Each has a knob with the name of its axis:
// dragging the knob, or moving it by keys, moves the slice across the axis.
import { significant } from "../base/format";
import { AXIS_NAMES, type AxisIndex } from "../base/grid";
import { slid_by_key } from "../base/slider";
import type { Viewer } from "../state/viewer";
import { type Projection, along_axis, project } from "./space/camera";
import { element } from "./dom";
import { labelled_edges } from "./space/edges";
import { type Space, from_space } from "./space/space";
import { type Point, type Rect, type Wish, end_text, place_numbers } from "./numbers";

const KNOB = 9; // pixels, half its size

// The corners of the panel, which belong to its title, the buttons and the triad.
const corners = (width: number, height: number): Rect[] => [
  { left: 0, top: 0, right: 60, bottom: 40 },
  { left: width - 312, top: 0, right: width, bottom: 40 },
  { left: width - 135, top: height - 36, right: width, bottom: height }, // the scale bar
  { left: 8, top: height - 90, right: 104, bottom: height - 22 }, // nearly a disc, together with the next one
  { left: 22, top: height - 104, right: 90, bottom: height - 8 },
];

export function make_rulers(viewer: Viewer, space: Space, slid: () => void) {
  const { units } = viewer;
  let view: Projection | null = null;
  const rulers = ([0, 1, 2] as const).map((d) => {
    const axis = viewer.axes[d];
    const name = AXIS_NAMES[d];
    const low = element("span", { class: `overview-number ${name}`, "aria-hidden": "true" }, end_text(axis, viewer.bounds[d].min));
    const high = element("span", { class: `overview-number ${name}`, "aria-hidden": "true" }, `${end_text(axis, viewer.bounds[d].max)} ${units}`);
    const knob = element(
      "div",
      {
        class: `overview-knob ${name}`,
        role: "slider",
        tabindex: "0",
        "aria-label": `Slice across ${name}, in the overview`,
        "aria-valuemin": "0",
        "aria-valuemax": String(axis.cells - 1),
        "aria-valuenow": String(viewer.cell.peek()[d]),
      },
      name,
    );
    listen_knob(knob, viewer, d, slid, (x, y) => {
      const edge = view && labelled_edges(view, space.half)[d];
      const p = edge && along_axis(view!, edge.a, d, x, y);
      return p == null ? null : axis.cell_at(from_space(space, d, p));
    });
    return { d, low, high, knob };
  });

  let sizes: (readonly [number, number])[] = []; // of the numbers, in pixels; they never change
  const measure = () => {
    if (rulers[0]!.low.offsetWidth > 0) sizes = rulers.flatMap(({ low, high }) => [low, high].map((e) => [e.offsetWidth, e.offsetHeight] as const));
  };
  const move = (e: HTMLElement, p: Point | null) => {
    e.hidden = p === null;
    if (p) e.style.transform = `translate(${p.x.toFixed(1)}px, ${p.y.toFixed(1)}px) translate(-50%, -50%)`;
  };

  return {
    roots: rulers.flatMap(({ low, high, knob }) => [low, high, knob]),
    update(to: Projection, at: readonly number[]) {
      view = to;
      if (sizes.length === 0) measure();
      if (sizes.length === 0) return;
      const edges = labelled_edges(to, space.half);
      const taken = corners(to.width, to.height);
      const seen: { e: HTMLElement; wish: Wish; length: number; upper: number }[] = [];
      for (const { d, low, high, knob } of rulers) {
        const edge = edges[d];
        const cell = viewer.cell.value[d];
        const text = `${significant(viewer.axes[d].centre(cell), 6)} ${units}, slice ${cell}`;
        knob.setAttribute("aria-valuenow", String(cell));
        knob.setAttribute("aria-valuetext", text);
        knob.title = `${AXIS_NAMES[d]} = ${text}: drag to move the slice`;
        if (!edge) {
          for (const e of [low, high, knob]) move(e, null);
          continue;
        }
        const middle = [...edge.a] as [number, number, number];
        middle[d] = at[d]!;
        const p = project(to, middle);
        move(knob, p);
        taken.push({ left: p.x - KNOB, top: p.y - KNOB, right: p.x + KNOB, bottom: p.y + KNOB });
        const [x, y] = [edge.to.x - edge.from.x, edge.to.y - edge.from.y];
        const length = Math.hypot(x, y);
        [low, high].forEach((e, upper) => {
          const sign = upper ? 1 : -1;
          const beyond = { x: (sign * x) / length, y: (sign * y) / length };
          seen.push({ e, length, upper, wish: { size: sizes[2 * d + upper]!, end: upper ? edge.to : edge.from, outward: edge.outward, beyond } });
        });
      }
      // Upper ends come first, because they name the unit, and then long edges before short ones.
      seen.sort((a, b) => b.upper - a.upper || b.length - a.length);
      const places = place_numbers(seen.map(({ wish }) => wish), to.width, to.height, taken);
      seen.forEach(({ e }, i) => move(e, places[i]!));
    },
  };
}

// `cell_at` takes a place in the panel and returns the cell along the axis; null when there is none.
function listen_knob(knob: HTMLElement, viewer: Viewer, d: AxisIndex, slid: () => void, cell_at: (x: number, y: number) => number | null): void {
  const go = (cell: number) => {
    viewer.set_slice(d, cell);
    slid();
  };
  knob.addEventListener("pointerdown", (event) => {
    knob.setPointerCapture(event.pointerId);
    knob.focus({ preventScroll: true });
    event.preventDefault();
  });
  knob.addEventListener("pointermove", (event) => {
    if (!knob.hasPointerCapture(event.pointerId)) return;
    const box = knob.parentElement!.getBoundingClientRect();
    const cell = cell_at(event.clientX - box.left, event.clientY - box.top);
    if (cell !== null) go(cell);
  });
  knob.addEventListener("keydown", (event) => {
    const to = slid_by_key(event.key, viewer.cell.value[d], 0, viewer.axes[d].cells - 1, event.shiftKey ? 10 : 1);
    if (to === null) return;
    go(to);
    event.preventDefault();
    event.stopPropagation();
  });
}
