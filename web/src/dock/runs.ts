// The runs of a column: which one holds a cell, where the next change is, and how runs are written.
import { type Axis, last_begun } from "../base/axis";
import { coordinate, csv_name, grouped, significant } from "../base/format";
import type { Column, ColumnRun } from "../base/grid";

// The run that holds a cell. REQUIRES: runs cover the axis in order.
export const run_at = (runs: readonly ColumnRun[], cell: number): number => last_begun(runs.length, (i) => runs[i]!.from <= cell);

// The first cell beyond the nearest change of material, up or down; the axis's end when there is none.
export function next_change(runs: readonly ColumnRun[], cell: number, up: boolean): number {
  const run = runs[run_at(runs, cell)]!;
  if (up) return run.to < runs.at(-1)!.to ? run.to : run.to - 1;
  return run.from > 0 ? run.from - 1 : 0;
}

// The length comes first, because a narrow window cuts the end off.
export function run_text(run: ColumnRun, axis: Axis, units: string): string {
  const width = axis.width(run.from);
  const cells = run.to - run.from;
  const at = (x: number) => coordinate(x, width);
  const range = cells === 1 ? `cell ${grouped(run.from)}` : `cells ${grouped(run.from)} to ${grouped(run.to - 1)} (${grouped(cells)})`;
  return `${run.name}: ${significant(run.max - run.min, 5)} ${units} long, ${range}, ${at(run.min)} to ${at(run.max)} ${units}`;
}

// The runs as a CSV file. `to` is the cell after the last one of the run.
export function runs_csv(columns: readonly Column[], units: string): string {
  const lines = [`axis,from,to,min_${units},max_${units},length_${units},id,material`];
  for (const column of columns)
    for (const r of column.runs) lines.push([column.axis, r.from, r.to, r.min, r.max, r.max - r.min, r.material, csv_name(r.name)].join(","));
  return `${lines.join("\n")}\n`;
}
