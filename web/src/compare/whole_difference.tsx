// What differs over the whole of two grids of equal cells, counted by the server.
import { type Signal, batch } from "@preact/signals";
import { grouped, noun, percent, plural } from "../base/format";
import { AXIS_NAMES, type AxisIndex, type Change, type Difference, type GridInfo, type Index3 } from "../base/grid";
import { say, words_of } from "../base/messages";
import { quoted } from "../base/shell";
import { BoxText } from "../panels/places";
import { FirstOf } from "../panels/first_of";
import { use_answer } from "../server/answer";
import { get_json } from "../server/api";
import { exact, show_place, totals_of, unequal_cells } from "../state/comparison";
import type { Box, Comparison } from "../state/viewer";
import { middle_cell, with_surroundings } from "../visits/go_there";
import { CodeLine } from "../widgets/copy";
import { Swatch } from "../widgets/swatch";
import { DifferenceMarks } from "./compared_place";
import type { Pair } from "./pair";

const MANY = 50; // changes that are listed at first

const in_slice = (box: Box, axis: AxisIndex, slice: number): Box => box.map((end, n) => (n === axis ? slice : n === axis + 3 ? slice + 1 : end)) as Box;

function Named({ pair, name }: { pair: Pair; name: string }) {
  const sides = [pair.left.viewer, pair.right.viewer];
  const look = sides.map((viewer) => viewer.looks.value[viewer.info.materials.findIndex((m) => m.name === name)]).find((found) => found);
  return (
    <span class="material-name">
      <Swatch look={look} />
      {name}
    </span>
  );
}

function ChangeLine({ pair, comparison, change, all }: { pair: Pair; comparison: Signal<Comparison>; change: Change; all: bigint }) {
  const { viewer } = pair.left;
  const { axis } = comparison.value;
  const { from, to, box } = change;
  const cells = exact(change.cells, change.cells_text);
  const [first, last] = [box[axis], box[axis + 3]! - 1];
  // The first and the last slice of the box certainly hold some of these cells.
  const places = [
    { label: "first", slice: first, within: in_slice(box, axis, first) },
    { label: "middle", slice: Math.floor((first + last) / 2), within: box },
    { label: "last", slice: last, within: in_slice(box, axis, last) },
  ];
  // To a cell that has changed, of that slice or near it.
  const go = async ({ slice, within }: (typeof places)[number]) => {
    batch(() => {
      comparison.value = { ...comparison.value, together: true, apart: 0 };
      viewer.box.value = box;
      viewer.set_cell(middle_cell(box));
      viewer.set_slice(axis, slice);
      viewer.frame(with_surroundings(viewer, box));
      show_place(viewer, comparison.value);
    });
    const here = viewer.cell.peek();
    const { cell } = await get_json<{ cell: Index3 | null }>(viewer.address.changed(pair.right.viewer.info.id, change, here, within));
    if (cell && viewer.cell.peek() === here) viewer.set_cell(cell); // unless somebody has moved on
  };
  return (
    <li class="change">
      <p class="change-names">
        <Named pair={pair} name={from} /> → <Named pair={pair} name={to} />
      </p>
      <p>
        {grouped(cells)} {noun(cells, "cell")} <span class="faint">{percent(Number(cells) / Number(all))}</span>
      </p>
      <details>
        <summary>Box</summary>
        <BoxText viewer={viewer} box={box} />
      </details>
      <p class="change-go">
        <span class="faint">Go to the</span>
        {places.slice(0, first === last ? 1 : 3).map((place) => (
          <button
            key={place.label}
            class="button small"
            aria-label={`Go there: ${place.label} slice across ${AXIS_NAMES[axis]} where ${from} became ${to}`}
            title={`${place.within === box ? "A cell near slice" : "Slice"} ${grouped(place.slice)} across ${AXIS_NAMES[axis]}`}
            onClick={() => void go(place).catch((error: unknown) => say(`The place can't be looked for: ${words_of(error)}.`))}
          >
            {first === last ? "only" : place.label}
          </button>
        ))}
        <span class="faint">slice across {AXIS_NAMES[axis]}</span>
      </p>
    </li>
  );
}

function Counted({ pair, comparison, difference }: { pair: Pair; comparison: Signal<Comparison>; difference: Difference }) {
  const [left, right] = [pair.left.viewer, pair.right.viewer];
  const all = exact(difference.cells, difference.cells_text);
  const differing = all - exact(difference.same, difference.same_text);
  if (differing === 0n) return <p>All of {grouped(all)} cells have the same material in both.</p>;
  return (
    <>
      <p>
        <b>{grouped(differing)}</b> of {plural(all, "cell")} {differing === 1n ? "differs" : "differ"}{" "}
        <span class="faint nowrap">({percent(Number(differing) / Number(all))})</span>. Counted exactly, by the names of materials.
      </p>
      <p class="comparison-marks">
        <DifferenceMarks totals={totals_of(difference.changes, left.info.materials[0]!.name, right.info.materials[0]!.name)} />
      </p>
      <FirstOf class="changes" list={difference.changes} step={MANY}>
        {(change) => <ChangeLine key={`${change.from} → ${change.to}`} pair={pair} comparison={comparison} change={change} all={all} />}
      </FirstOf>
    </>
  );
}

// The command may take as long as it needs.
function NotCounted({ error, own, other }: { error: string; own: string; other: string }) {
  return (
    <>
      <p class="note">The cells that differ were not counted: {error}. This does, where both have the same cells:</p>
      <CodeLine class="hash" text={`teracell diff ${quoted(`${own}.tcell`)} ${quoted(`${other}.tcell`)}`} what="the command" />
    </>
  );
}

// `info`: the grid on the right as the server describes it, in its own unit.
export function WholeDifference({ pair, comparison, info }: { pair: Pair; comparison: Signal<Comparison>; info: GridInfo }) {
  const own = pair.left.viewer.info;
  const same = own.id === info.id;
  const unequal = unequal_cells(own, info);
  const answer = use_answer<Difference>(same || unequal ? null : pair.left.viewer.address.diff(info.id));
  return (
    <div class="panel-content">
      <section>
        <h2>Over the whole grids</h2>
        {same && <p class="note">Both slices are of the same grid. Choose another grid above to count what differs.</p>}
        {!same && unequal && (
          <p class="note">
            Cells can be counted against each other only where both grids have the same ones: {unequal}. The slices can be compared all the
            same: each point lies at the same place in both.
          </p>
        )}
        {!same && !unequal && answer.error && <NotCounted error={answer.error} own={own.id} other={info.id} />}
        {!same && !unequal && !answer.error && !answer.value && (
          <p class="note" role="status">
            Counting the cells that differ …
          </p>
        )}
      </section>
      {answer.value && <Counted pair={pair} comparison={comparison} difference={answer.value} />}
    </div>
  );
}
