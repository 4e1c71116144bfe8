// Boxes of cells, half open, and their statistics as a table for other programs.
import { csv_name } from "../base/format";
import type { AxisIndex, Stats } from "../base/grid";
import type { Box } from "../state/viewer";

// A box with one of its ends moved. It stays within the axis and keeps at least one cell: the other end makes way.
export function with_end(box: Box, axis: AxisIndex, end: "low" | "high", to: number, cells: number): Box {
  const out: Box = [...box];
  if (end === "low") {
    out[axis] = Math.min(Math.max(to, 0), cells - 1);
    out[axis + 3] = Math.max(out[axis + 3]!, out[axis] + 1);
  } else {
    out[axis + 3] = Math.min(Math.max(to, 1), cells);
    out[axis] = Math.min(out[axis], out[axis + 3]! - 1);
  }
  return out;
}

export function stats_csv(stats: Stats, units: string): string {
  const lines = [`id,material,cells,volume_${units}3,x0,y0,z0,x1,y1,z1`];
  for (const m of stats.materials)
    lines.push([m.id, csv_name(m.name), m.cells_text ?? m.cells, m.volume, ...(m.box ?? ["", "", "", "", "", ""])].join(","));
  return `${lines.join("\n")}\n`;
}
