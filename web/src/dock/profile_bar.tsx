// One column as a bar, true to scale, with round coordinates below it. A click, a drag or the arrow keys move the slice
// across its axis.
import { useEffect, useRef, useState } from "preact/hooks";
import { coordinate, grouped } from "../base/format";
import { AXIS_NAMES, type AxisIndex, type Column, type Index3 } from "../base/grid";
import { slid_by_key } from "../base/slider";
import { ticks } from "../base/ticks";
import { theme } from "../state/theme";
import type { Viewer } from "../state/viewer";
import { next_change, run_at } from "./runs";

const BAR = 12; // CSS pixels
const HEIGHT = 25;

interface Props {
  viewer: Viewer;
  axis: AxisIndex;
  cell: Index3;
  column: Column | null;
  point_at: (run: number | null) => void;
}

// Runs narrower than a pixel are visible as well: they are drawn after the wide ones, a pixel wide.
function draw(canvas: HTMLCanvasElement, width: number, { viewer, axis: d, cell, column }: Props): void {
  const ratio = devicePixelRatio;
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = HEIGHT * ratio;
  const context = canvas.getContext("2d")!;
  context.scale(ratio, ratio);
  const style = getComputedStyle(canvas);
  const axis = viewer.axes[d];
  const at = (x: number) => ((x - axis.min) / (axis.max - axis.min)) * width;
  context.fillStyle = style.getPropertyValue("--sunken");
  context.fillRect(0, 0, width, BAR);
  const thin: [number, string][] = [];
  for (const run of column?.runs ?? []) {
    const look = viewer.looks.value[run.material]!;
    if (!look.visible || look.opacity === 0) continue;
    const color = `rgb(${look.color.join(" ")} / ${look.opacity})`;
    const left = at(run.min);
    const right = at(run.max);
    if (right - left < 1) {
      if (run.material > 0) thin.push([Math.floor(left), color]);
      continue;
    }
    context.fillStyle = color;
    context.fillRect(left, 0, right - left, BAR);
  }
  for (const [left, color] of thin) {
    context.fillStyle = color;
    context.fillRect(left, 0, 1, BAR);
  }
  const places = ticks(axis.min, axis.max, Math.max(2, Math.floor(width / 90)));
  const step = places.length > 1 ? Math.abs(places[1]! - places[0]!) : axis.max - axis.min;
  context.font = `10px ${style.fontFamily}`;
  context.textBaseline = "top";
  context.fillStyle = style.getPropertyValue("--faint");
  for (const x of places) {
    const label = coordinate(x, 10 * step);
    const half = context.measureText(label).width / 2;
    context.fillRect(Math.round(at(x)), BAR, 1, 3);
    context.fillText(label, Math.min(Math.max(at(x) - half, 0), width - 2 * half), BAR + 4);
  }
  const mark = (i: number, color: string, line: number) => {
    const x = Math.round(at(axis.centre(i)));
    context.fillStyle = style.getPropertyValue("--surface");
    context.fillRect(x - line / 2 - 1, 0, line + 2, BAR + 3);
    context.fillStyle = color;
    context.fillRect(x - line / 2, 0, line, BAR + 3);
  };
  if (cell[d] !== viewer.cell.value[d]) mark(cell[d], style.getPropertyValue("--faint"), 1);
  mark(viewer.cell.value[d], style.getPropertyValue(`--axis-${AXIS_NAMES[d]}`), 2);
}

export function ProfileBar(props: Props) {
  const { viewer, axis: d, column, point_at } = props;
  const canvas = useRef<HTMLCanvasElement>(null);
  const [width, set_width] = useState(0);
  const axis = viewer.axes[d];
  useEffect(() => {
    const observer = new ResizeObserver(([entry]) => set_width(Math.floor(entry!.contentRect.width)));
    observer.observe(canvas.current!.parentElement!);
    return () => observer.disconnect();
  }, []);
  // Signals that the picture depends on.
  const here = viewer.cell.value[d];
  const looks = viewer.looks.value;
  const colors = theme.value;
  useEffect(() => {
    if (width > 0) draw(canvas.current!, width, props);
  }, [width, column, here, props.cell[d], looks, colors]);

  const cell_at = (event: PointerEvent) => {
    const box = canvas.current!.getBoundingClientRect();
    return axis.clamp(axis.cell_at(axis.min + ((event.clientX - box.left) / box.width) * (axis.max - axis.min)));
  };
  const on_move = (event: PointerEvent) => {
    const i = cell_at(event);
    if (column) point_at(run_at(column.runs, i));
    if (event.buttons & 1) viewer.set_slice(d, i);
  };
  const on_down = (event: PointerEvent) => {
    if (event.button !== 0) return;
    canvas.current!.setPointerCapture(event.pointerId);
    viewer.set_slice(d, cell_at(event));
  };
  const on_key = (event: KeyboardEvent) => {
    const pages = event.key === "PageUp" || event.key === "PageDown";
    const change = column ? next_change(column.runs, here, event.key === "PageUp") : here;
    const to = pages ? change : slid_by_key(event.key, here, 0, axis.cells - 1);
    if (to === null || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    viewer.set_slice(d, to);
    if (column) point_at(run_at(column.runs, viewer.cell.peek()[d]));
  };
  const material = column?.runs[run_at(column.runs, here)]?.name;
  const value = `cell ${grouped(here)}, ${coordinate(axis.centre(here), axis.width(here))} ${viewer.units}${material ? `, ${material}` : ""}`;
  return (
    <div class="profile-bar">
      <canvas
        ref={canvas}
        style={{ width: "100%", height: `${HEIGHT}px` }}
        tabIndex={0}
        role="slider"
        aria-label={`Column along ${AXIS_NAMES[d]}: moves the slice`}
        aria-valuemin={0}
        aria-valuemax={axis.cells - 1}
        aria-valuenow={here}
        aria-valuetext={value}
        title="Click to move the slice there. Arrow keys step; Page Up and Page Down go to the next change of material."
        onPointerDown={on_down}
        onPointerMove={on_move}
        onPointerLeave={() => point_at(null)}
        onBlur={() => point_at(null)}
        onKeyDown={on_key}
      />
    </div>
  );
}
