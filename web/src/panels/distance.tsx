// What was measured: lines with their lengths, what the chosen one passes through, and how thick a material is along the axes.
import { coordinate, grouped, significant } from "../base/format";
import { length_text } from "../base/lengths";
import { FRAMES } from "../base/axis";
import { AXES, AXIS_NAMES, type AxisIndex, type Column, type Index3, type LineAnswer } from "../base/grid";
import { use_answer, use_settled } from "../server/answer";
import { axis_named } from "../state/comparison";
import { length_of, measures_csv, name_of_measure, put_measure, remove_measure } from "../state/measures";
import type { Measure, Viewer } from "../state/viewer";
import { choose_tool, measure_thickness } from "../views/actions";
import { Fact } from "../widgets/fact";
import { CopyButton } from "../widgets/copy";
import { IconButton } from "../widgets/icons";
import { Swatch } from "../widgets/swatch";

const MOST = 50; // runs that are listed
const SETTLED = 150; // milliseconds
const REMAINDER = 1e-9; // a stretch so short, as a share of the line, is the rounding of a place on a boundary

function Line({ viewer, measure }: { viewer: Viewer; measure: Measure }) {
  const { units } = viewer;
  const parts = AXES.map((d) => measure.to[d] - measure.from[d]);
  const is_point = parts.every((x) => x === 0);
  const settled = use_settled(is_point ? null : viewer.address.line(measure.from, measure.to), SETTLED);
  const answer = use_answer<LineAnswer>(settled);
  // Until the answer for this line comes, that of the one before it is shown as such; after an error, or for a point, none.
  const waits = answer.path !== viewer.address.line(measure.from, measure.to);
  const runs = is_point || answer.error ? [] : (answer.value?.runs ?? []).filter((run) => run.length > REMAINDER * length_of(measure));
  return (
    <>
      <dl class="numbers">
        <Fact name="distance">
          <b>
            {significant(length_of(measure), 6)} {units}
          </b>
        </Fact>
        {AXES.filter((d) => d !== measure.axis).map((d) => (
          <Fact key={d} name={`along ${AXIS_NAMES[d]}`}>
            {significant(Math.abs(parts[d]!), 6)} {units}
          </Fact>
        ))}
      </dl>
      {answer.error && <p class="problem">What the line passes through can't be told: {answer.error}</p>}
      {runs.length > 0 && (
        <table class={`stats ${waits ? "counting" : ""}`} aria-busy={waits} aria-label="What the line passes through">
          <thead>
            <tr>
              <th scope="col">through</th>
              <th scope="col">cells</th>
              <th scope="col">{units}</th>
            </tr>
          </thead>
          <tbody>
            {runs.slice(0, MOST).map((run, n) => (
              <tr key={n}>
                <th scope="row">
                  <Swatch look={viewer.looks.value[run.material]} />
                  <span title={run.name}>{run.name}</span>
                </th>
                <td>{grouped(run.cells)}</td>
                <td>{significant(run.length, 5)}</td>
              </tr>
            ))}
            {runs.length > MOST && (
              <tr>
                <td colSpan={3}>and {grouped(runs.length - MOST)} more</td>
              </tr>
            )}
          </tbody>
        </table>
      )}
    </>
  );
}

function use_run(viewer: Viewer, d: AxisIndex, cell: Index3) {
  const address = viewer.address.column(d, cell[FRAMES[d].u], cell[FRAMES[d].v]);
  const { value, path } = use_answer<Column>(address);
  return (path === address ? value : null)?.runs.find(({ from, to }) => from <= cell[d] && cell[d] < to) ?? null;
}

function Thickness({ viewer, cell }: { viewer: Viewer; cell: Index3 }) {
  const runs = [use_run(viewer, 0, cell), use_run(viewer, 1, cell), use_run(viewer, 2, cell)];
  const material = runs.find((run) => run)?.material;
  const { units, axes } = viewer;
  return (
    <dl class="numbers">
      <Fact name="thickness of">
        {material === undefined ? (
          "…"
        ) : (
          <>
            <Swatch look={viewer.looks.value[material]} /> {viewer.info.materials[material]!.name}
          </>
        )}
      </Fact>
      {AXES.map((d) => {
        const run = runs[d];
        const at = (x: number) => coordinate(x, axes[d].width(cell[d]));
        return (
          <Fact key={d} name={`along ${AXIS_NAMES[d]}`} {...(run && { title: `from ${at(run.min)} to ${at(run.max)} ${units}` })}>
            {run ? `${significant(run.max - run.min, 5)} ${units}, ${grouped(run.to - run.from)} ${run.to - run.from === 1 ? "cell" : "cells"}` : "…"}
          </Fact>
        );
      })}
    </dl>
  );
}

// A line for each; a click chooses it, and its name can be changed.
function Lines({ viewer }: { viewer: Viewer }) {
  const { measures, chosen } = viewer;
  return (
    <>
      <ul class="measures" aria-label="Measured lines">
        {measures.value.map((m, n) => {
          const name = name_of_measure(m, n);
          const choose = () => (chosen.value = m.id);
          return (
            <li key={m.id} class={m.id === chosen.value ? "chosen" : ""} onClick={choose}>
              <input
                aria-label={`Name of line ${n + 1}`}
                aria-current={m.id === chosen.value}
                value={name}
                maxLength={60}
                onFocus={choose}
                onChange={(e) => put_measure(viewer, { ...m, name: e.currentTarget.value.trim() })}
              />
              <span class="length">{length_text(length_of(m), viewer.info.units, 5)}</span>
              <IconButton
                icon="close"
                label={`Remove ${name}`}
                onClick={(e: Event) => {
                  e.stopPropagation();
                  remove_measure(viewer, m.id);
                }}
              />
            </li>
          );
        })}
      </ul>
      <div class="toolbar">
        <CopyButton label="Copy as CSV" what="the lines as CSV" text={() => measures_csv(measures.value, viewer.info.units)} />
      </div>
    </>
  );
}

export function Distance({ viewer }: { viewer: Viewer }) {
  const { measure, measures, chosen, thickness, tool } = viewer;
  return (
    <section>
      <h3>Distance and thickness</h3>
      <div class="toolbar">
        <button class="button" aria-pressed={tool.value === "measure"} onClick={() => choose_tool(viewer, "measure")}>
          Measure
        </button>
        <button class="button" title="Of the material at the crosshair, along each axis" onClick={() => measure_thickness(viewer, axis_named(viewer.layout.value), viewer.cell.value)}>
          Thickness
        </button>
        <span class="spacer" />
        {(measures.value.length > 0 || thickness.value) && (
          <button
            class="button"
            onClick={() => {
              measures.value = [];
              chosen.value = null;
              thickness.value = null;
            }}
          >
            Clear all
          </button>
        )}
      </div>
      {thickness.value && <Thickness viewer={viewer} cell={thickness.value} />}
      {measure.value && <Line viewer={viewer} measure={measure.value} />}
      {measures.value.length > 0 && <Lines viewer={viewer} />}
      {measures.value.length === 0 && !thickness.value && (
        <p class="note">
          In a slice, drag from one place to another: the ends snap to boundaries of materials, unless you hold alt. In 3D, click a surface at
          each end. Shift and a click measure how thick the material is there: in a slice along the axes, in 3D along the surface's normal.
        </p>
      )}
    </section>
  );
}
