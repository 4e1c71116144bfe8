// A box of cells, drawn in a view or typed, and what is in it, counted exactly. Also what was measured.
import { signal } from "@preact/signals";
import { coordinate, grouped, percent, product, significant } from "../base/format";
import { AXES, AXIS_NAMES, type AxisIndex, type Stats } from "../base/grid";
import { use_answer, use_settled } from "../server/answer";
import type { Box, Viewer } from "../state/viewer";
import { CopyButton } from "../widgets/copy";
import { choose_tool } from "../views/actions";
import { nearest_plane } from "../views/drawing/box_handles";
import { Icon } from "../widgets/icons";
import { Segmented } from "../widgets/segmented";
import { Swatch } from "../widgets/swatch";
import { stats_csv, with_end } from "./box_cells";
import { Distance } from "./distance";
import { cells_of } from "./look_card";
import { TakeOut } from "./take_out";

const MOST = 200; // materials that are listed

const in_lengths = signal(false); // whether the ends of the box are shown as coordinates, not as cells

// Both ends along an axis, as the first and the last cell or as coordinates of planes between cells. They change when the field is
// left or Enter is pressed, so that nothing jumps while somebody types.
function Range({ viewer, box, axis: d, lengths }: { viewer: Viewer; box: Box; axis: AxisIndex; lengths: boolean }) {
  const axis = viewer.axes[d];
  const [low, high] = [box[d], box[d + 3]!];
  const shown = (end: "low" | "high", b: Box) => {
    const plane = end === "low" ? b[d] : b[d + 3]!;
    return lengths ? String(Number(axis.plane(plane).toPrecision(12))) : String(end === "low" ? plane : plane - 1);
  };
  const set = (end: "low" | "high", field: HTMLInputElement) => {
    const value = Number(field.value);
    const plane = lengths ? nearest_plane(axis, value) : Math.round(value) + (end === "high" ? 1 : 0);
    if (field.value.trim() && Number.isFinite(value)) viewer.box.value = with_end(box, d, end, plane, axis.cells);
    field.value = shown(end, viewer.box.value!);
  };
  const name = AXIS_NAMES[d];
  const what = (end: "low" | "high") => (lengths ? `${end === "low" ? "Lower" : "Upper"} end along ${name} in ${viewer.units}` : `${end === "low" ? "First" : "Last"} cell along ${name}`);
  const limits = lengths ? { step: "any" } : { min: 0, max: axis.cells - 1 };
  const field = (end: "low" | "high") => (
    <td>
      <input class="number-input" type="number" aria-label={what(end)} {...limits} value={shown(end, box)} onChange={(e) => set(end, e.currentTarget)} />
    </td>
  );
  const extent = lengths ? `${grouped(high - low)} ${high - low === 1 ? "cell" : "cells"}` : `${significant(axis.plane(high) - axis.plane(low), 5)} ${viewer.units}`;
  return (
    <tr class={`axis-${name}`}>
      <th scope="row">{name}</th>
      {field("low")}
      {field("high")}
      <td
        class="extent"
        title={`${coordinate(axis.plane(low), axis.width(low))} to ${coordinate(axis.plane(high), axis.width(high - 1))} ${viewer.units}`}
      >
        {extent}
      </td>
    </tr>
  );
}

function Content({ viewer, box }: { viewer: Viewer; box: Box }) {
  const settled = use_settled(box.join(), 150);
  const path = viewer.address.stats(settled.split(",").map(Number));
  const answer = use_answer<Stats>(path);
  const counting = answer.path !== viewer.address.stats(box);
  const stats = answer.error === null ? answer.value : null; // not that of an earlier box
  const all = product(AXES.map((d) => box[d + 3]! - box[d]));
  const { units } = viewer;
  const present = stats?.materials.filter((m) => m.cells > 0) ?? [];
  const volume = present.reduce((sum, m) => sum + m.volume, 0);
  return (
    <>
      {answer.error && <p class="problem">What is in the box can't be counted: {answer.error}</p>}
      <table class={`stats ${counting ? "counting" : ""}`} aria-busy={counting}>
        <thead>
          <tr>
            <th scope="col">material</th>
            <th scope="col">cells</th>
            <th scope="col">share</th>
            <th scope="col">{units}³</th>
          </tr>
        </thead>
        <tbody>
          {present.slice(0, MOST).map((m) => (
            <tr key={m.id}>
              <th scope="row">
                <Swatch look={viewer.looks.value[m.id]} />
                <span title={m.name}>{m.name}</span>
              </th>
              <td>{cells_of(m)}</td>
              <td>{percent(m.cells / Number(all))}</td>
              <td>{significant(m.volume, 5)}</td>
            </tr>
          ))}
          {present.length > MOST && (
            <tr>
              <td colSpan={4}>{grouped(present.length - MOST)} more; all are in the CSV</td>
            </tr>
          )}
        </tbody>
        <tfoot>
          <tr>
            <th scope="row">all</th>
            <td>{grouped(all)}</td>
            <td />
            <td>{stats ? significant(volume, 5) : answer.error && "can't be counted"}</td>
          </tr>
        </tfoot>
      </table>
      <div class="toolbar">
        <button class="button" onClick={() => viewer.go_to_box(box)}>
          <Icon name="target" /> Look at it
        </button>
        {stats && <CopyButton label="Copy as CSV" what="the statistics as CSV" text={() => stats_csv(stats, viewer.info.units)} />}
        <span class="spacer" />
        <button class="button" onClick={() => (viewer.box.value = null)}>
          Clear
        </button>
      </div>
    </>
  );
}

export function BoxPanel({ viewer }: { viewer: Viewer }) {
  const box = viewer.box.value;
  const drawing = viewer.tool.value === "box";
  const lengths = in_lengths.value;
  return (
    <>
      <section>
        <h3>Box of cells</h3>
        <div class="toolbar">
          <button class="button" aria-pressed={drawing} onClick={() => choose_tool(viewer, "box")}>
            <Icon name="box" /> Draw in a view
          </button>
          {!box && (
            <button class="button" onClick={() => (viewer.box.value = [0, 0, 0, ...viewer.cells])}>
              Whole grid
            </button>
          )}
          <span class="spacer" />
          {box && (
            <Segmented
              label="Ends of the box"
              value={lengths ? 1 : 0}
              list={["cells", viewer.units].map((text, value) => ({ value, text }))}
              set={(value) => (in_lengths.value = value === 1)}
            />
          )}
        </div>
        {box ? (
          <>
            <table class="ranges">
              <thead>
                <tr>
                  <td />
                  <th scope="col">{lengths ? `from [${viewer.units}]` : "first cell"}</th>
                  <th scope="col">{lengths ? `to [${viewer.units}]` : "last cell"}</th>
                  <th scope="col">extent</th>
                </tr>
              </thead>
              <tbody>
                {AXES.map((d) => (
                  <Range key={`${d} ${lengths}`} viewer={viewer} box={box} axis={d} lengths={lengths} />
                ))}
              </tbody>
            </table>
            <Content viewer={viewer} box={box} />
          </>
        ) : (
          <p class="note">
            Draw a box in a view, or take the whole grid and type its ends. The cells and the volume of every material in it are counted exactly.
          </p>
        )}
      </section>
      {box && <TakeOut viewer={viewer} box={box} />}
      <Distance viewer={viewer} />
    </>
  );
}
