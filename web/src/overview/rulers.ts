// The domain's edges as rulers: the ends' coordinates, and on each a knob with the axis's name that is dragged, or moved by keys, to move
// the slice across it.
import { AXIS_NAMES, type AxisIndex } from "../api";
import { significant } from "../format";
import type { Viewer } from "../viewer";
import { type Projection, along_axis, project } from "./camera";
import { element } from "./dom";
import { labelled_edges } from "./edges";
import { type Space, from_space } from "./level_axis";

export interface Rulers {
  readonly roots: readonly HTMLElement[];
  update(view: Projection, at: readonly number[]): void;
}

const GAP = 5; // pixels between an edge and its numbers

const short = (x: number) => significant(x, 5).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "");

export function make_rulers(viewer: Viewer, space: Space, slid: () => void): Rulers {
  const { units } = viewer;
  let view: Projection | null = null;
  const rulers = ([0, 1, 2] as const).map((d) => {
    const axis = viewer.axes[d];
    const name = AXIS_NAMES[d];
    const low = element("span", { class: "overview-number", "aria-hidden": "true" }, short(axis.min));
    const high = element("span", { class: "overview-number", "aria-hidden": "true" }, `${short(axis.max)} ${units}`);
    const knob = element("div", { class: `overview-knob ${name}`, role: "slider", tabindex: "0", "aria-label": `slice across ${name}`, "aria-valuemin": "0", "aria-valuemax": String(axis.cells - 1) }, name);
    listen_knob(knob, viewer, d, slid, (x, y) => {
      const edge = view && labelled_edges(view, space.half)[d];
      const p = edge && along_axis(view!, edge.a, d, x, y);
      return p == null ? null : axis.cell_at(from_space(space, d, p));
    });
    return { d, low, high, knob };
  });

  let sizes: (readonly [number, number])[] = []; // of the numbers, in pixels: they never change

  return {
    roots: rulers.flatMap(({ low, high, knob }) => [low, high, knob]),
    update(to, at) {
      view = to;
      const edges = labelled_edges(to, space.half);
      if (sizes.length === 0 && rulers[0]!.low.offsetWidth > 0) sizes = rulers.flatMap(({ low, high }) => [low, high].map((e) => [e.offsetWidth, e.offsetHeight] as const));
      for (const { d, low, high, knob } of rulers) {
        const edge = edges[d];
        for (const e of [low, high, knob]) e.hidden = !edge;
        const cell = viewer.cell.value[d];
        const text = `${significant(viewer.axes[d].centre(cell), 6)} ${units}, slice ${cell}`;
        knob.setAttribute("aria-valuenow", String(cell));
        knob.setAttribute("aria-valuetext", text);
        knob.title = `${AXIS_NAMES[d]} = ${text}: drag to move the slice`;
        if (!edge || sizes.length === 0) continue;
        const length = Math.hypot(edge.to.x - edge.from.x, edge.to.y - edge.from.y);
        // The text lies outside the box, and from the end of its edge towards the middle: so two edges' texts at a corner keep apart.
        const put = (e: HTMLElement, [w, h]: readonly [number, number], p: { x: number; y: number }, inward: number) => {
          const [ox, oy] = [edge.outward.x, edge.outward.y];
          const away = GAP + (w * Math.abs(ox) + h * Math.abs(oy)) / 2;
          const along = (inward * 0.4 * (w * Math.abs(oy) + h * Math.abs(ox))) / length;
          const x = p.x + ox * away + (edge.to.x - edge.from.x) * along;
          const y = p.y + oy * away + (edge.to.y - edge.from.y) * along;
          e.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
        };
        put(low, sizes[2 * d]!, edge.from, 1);
        put(high, sizes[2 * d + 1]!, edge.to, -1);
        const middle = [...edge.a] as [number, number, number];
        middle[d] = at[d]!;
        const p = project(to, middle);
        knob.style.transform = `translate(${p.x.toFixed(1)}px, ${p.y.toFixed(1)}px) translate(-50%, -50%)`;
      }
    },
  };
}

// `cell_at` takes a place in the panel.
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
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (step !== undefined) go(viewer.cell.value[d] + step * (event.shiftKey ? 10 : 1));
    else if (event.key === "Home") go(0);
    else if (event.key === "End") go(viewer.axes[d].cells - 1);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
}
