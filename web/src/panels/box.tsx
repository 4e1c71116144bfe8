// A box of cells, drawn in a view or typed, and what is in it, counted exactly. Also the last measured
// distance.
import { coordinate, grouped, percent, product, significant } from "../base/format";
import { AXES, AXIS_NAMES, type AxisIndex, type Stats } from "../base/grid";
import { use_answer, use_settled } from "../server/answer";
import type { Box, Viewer } from "../state/viewer";
import { CopyButton } from "../widgets/copy";
import { Fact } from "../widgets/fact";
import { Icon } from "../widgets/icons";
import { Swatch } from "../widgets/swatch";
import { stats_csv, with_end } from "./box_cells";
import { cells_of } from "./look_card";

const MOST = 200; // materials that are listed

// The first and the last cell along an axis. They change when the field is left or Enter is pressed, so that nothing
// jumps while somebody types.
function Range({ viewer, box, axis: d }: { viewer: Viewer; box: Box; axis: AxisIndex }) {
  const axis = viewer.axes[d];
  const [low, high] = [box[d], box[d + 3]!];
  const set = (end: "low" | "high", field: HTMLInputElement) => {
    const value = Math.round(Number(field.value));
    if (field.value.trim() && Number.isFinite(value)) viewer.box.value = with_end(box, d, end, end === "high" ? value + 1 : value, axis.cells);
    field.value = String(end === "high" ? viewer.box.value![d + 3]! - 1 : viewer.box.value![d]);
  };
  const name = AXIS_NAMES[d];
  const field = (end: "low" | "high", value: number) => (
    <td>
      <input
        class="number-input"
        type="number"
        aria-label={`${end === "low" ? "First" : "Last"} cell along ${name}`}
        min={0}
        max={axis.cells - 1}
        value={value}
        onChange={(e) => set(end, e.currentTarget)}
      />
    </td>
  );
  return (
    <tr class={`axis-${name}`}>
      <th scope="row">{name}</th>
      {field("low", low)}
      {field("high", high - 1)}
      <td
        class="extent"
        title={`${coordinate(axis.plane(low), axis.width(low))} to ${coordinate(axis.plane(high), axis.width(high - 1))} ${viewer.units}`}
      >
        {significant(axis.plane(high) - axis.plane(low), 5)} {viewer.units}
      </td>
    </tr>
  );
}

function Content({ viewer, box }: { viewer: Viewer; box: Box }) {
  const settled = use_settled(box.join(), 150);
  const path = viewer.address.stats(settled.split(",").map(Number));
  const answer = use_answer<Stats>(path);
  const counting = answer.path !== viewer.address.stats(box);
  const stats = answer.value;
  const all = product(AXES.map((d) => box[d + 3]! - box[d]));
  const { units } = viewer;
  const present = stats?.materials.filter((m) => m.cells > 0) ?? [];
  const volume = present.reduce((sum, m) => sum + m.volume, 0);
  return (
    <>
      {answer.error && <p class="problem">The cells can't be counted: {answer.error}</p>}
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
            <td>{significant(volume, 5)}</td>
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

function Distance({ viewer }: { viewer: Viewer }) {
  const m = viewer.measure.value;
  const { units } = viewer;
  const parts = m ? AXES.map((d) => m.to[d] - m.from[d]) : [];
  return (
    <section>
      <h3>Distance</h3>
      <div class="toolbar">
        <button
          class="button"
          aria-pressed={viewer.tool.value === "measure"}
          onClick={() => (viewer.tool.value = viewer.tool.value === "measure" ? "look" : "measure")}
        >
          Measure in a view
        </button>
        <span class="spacer" />
        {m && (
          <button class="button" onClick={() => (viewer.measure.value = null)}>
            Clear
          </button>
        )}
      </div>
      {m ? (
        <dl class="numbers">
          <Fact name="distance">
            <b>
              {significant(Math.hypot(...parts), 6)} {units}
            </b>
          </Fact>
          {AXES.filter((d) => d !== m.axis).map((d) => (
            <Fact key={d} name={`along ${AXIS_NAMES[d]}`}>
              {significant(Math.abs(parts[d]!), 6)} {units}
            </Fact>
          ))}
        </dl>
      ) : (
        <p class="note">Drag from one place to another.</p>
      )}
    </section>
  );
}

export function BoxPanel({ viewer }: { viewer: Viewer }) {
  const box = viewer.box.value;
  const drawing = viewer.tool.value === "box";
  return (
    <>
      <section>
        <h3>Box of cells</h3>
        <div class="toolbar">
          <button class="button" aria-pressed={drawing} onClick={() => (viewer.tool.value = drawing ? "look" : "box")}>
            <Icon name="box" /> Draw in a view
          </button>
          {!box && (
            <button class="button" onClick={() => (viewer.box.value = [0, 0, 0, ...viewer.cells])}>
              Whole grid
            </button>
          )}
        </div>
        {box ? (
          <>
            <table class="ranges">
              <thead>
                <tr>
                  <td />
                  <th scope="col">first cell</th>
                  <th scope="col">last cell</th>
                  <th scope="col">extent</th>
                </tr>
              </thead>
              <tbody>
                {AXES.map((d) => (
                  <Range key={d} viewer={viewer} box={box} axis={d} />
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
      <Distance viewer={viewer} />
    </>
  );
}
