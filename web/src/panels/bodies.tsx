// The bodies, where the file keeps them apart: how they look, and exactly how much of the grid they fill.
import { grouped, product } from "../base/format";
import { type Amount, type CellAnswer, without_overlap } from "../base/grid";
import { use_answer } from "../server/answer";
import { use_stats } from "../visits/amounts";
import { change_bodies, show_all_bodies, show_only, with_change } from "../state/bodies";
import { go_to_labels } from "../visits/go_there";
import type { Viewer } from "../state/viewer";
import { type Item, LookCard } from "./look_card";
import { LookList } from "./look_list";
import { distinct_color } from "./palette";

function items_of(viewer: Viewer, amounts: readonly Amount[] | null): Item[] {
  const looks = viewer.label_looks.value;
  const wholes = viewer.wholes;
  const visible = wholes.filter((label) => looks[label]!.visible);
  return wholes.map((label) => {
    const { material, body } = viewer.labels[label]!;
    const { name } = viewer.info.materials[material]!;
    const alone = visible.length === 1 && visible[0] === label;
    return {
      id: label,
      name: body || name,
      beside: body ? name : "background",
      look: looks[label]!,
      alone,
      amount: amounts?.[label] ?? null,
      change: (what) => change_bodies(viewer, [label], what),
      show_alone: () => (alone ? show_all_bodies(viewer) : show_only(viewer, [label])),
      go_there: () => void go_to_labels(viewer, [label]),
    };
  });
}

// The body of the cell that a click has pinned, in a slice or in three dimensions.
function use_picked(viewer: Viewer): number {
  const pinned = viewer.pinned.value;
  const address = pinned && viewer.address.cell(pinned);
  const answer = use_answer<CellAnswer>(address);
  return address !== null && answer.path === address ? without_overlap(viewer.labels, answer.value?.bodies?.[0]?.label ?? -1) : -1;
}

function Found({ viewer, found }: { viewer: Viewer; found: readonly Item[] }) {
  const labels = found.map(({ id }) => id);
  return (
    <div class="toolbar">
      <button class="button small" onClick={() => show_only(viewer, labels)}>
        {labels.length === 1 ? "Show only this one" : `Show only these ${grouped(labels.length)}`}
      </button>
      <button class="button small" onClick={() => change_bodies(viewer, labels, { visible: false })}>
        Hide these
      </button>
      <button class="button small" onClick={() => change_bodies(viewer, labels, { visible: true })}>
        Show these
      </button>
    </div>
  );
}

export function BodiesPanel({ viewer }: { viewer: Viewer }) {
  const stats = use_stats(viewer);
  const label = use_picked(viewer);
  const all = Number(product(viewer.cells));
  const items = items_of(viewer, stats.value && viewer.amounts);
  const picked = items.find(({ id }) => id === label);
  const own_looks = viewer.body_looks.value;
  const colored = [...own_looks.values()].some(({ color }) => color !== undefined);
  const bodies = viewer.wholes.filter((label) => viewer.labels[label]!.body); // without the background
  const give_colors = () => {
    viewer.body_looks.value = with_change(own_looks, bodies, (label) => ({ color: distinct_color(label) }));
  };
  return (
    <>
      <div class="toolbar">
        <button class="button" disabled={items.every(({ look }) => look.visible)} onClick={() => show_all_bodies(viewer)}>
          Show all
        </button>
        <button class="button" disabled={colored} title={colored ? "Some bodies have colours of their own: Reset takes these away first" : "Give each body a colour of its own"} onClick={give_colors}>
          Colour each
        </button>
        <span class="spacer" />
        <button
          class="button"
          disabled={own_looks.size === 0}
          title="Bodies look like their materials again"
          onClick={() => (viewer.body_looks.value = new Map())}
        >
          Reset
        </button>
      </div>
      {stats.error && <p class="problem">The cells can't be counted: {stats.error}</p>}
      {!picked ? (
        <p class="note">Click a body in a view to have it here.</p>
      ) : (
        <section aria-label="The body of the pinned cell">
          <h3>Picked</h3>
          <ul class="materials">
            <LookCard key={label} short={false} viewer={viewer} item={picked} all={all} />
          </ul>
          <h3>All</h3>
        </section>
      )}
      <LookList
        viewer={viewer}
        items={items}
        what="bodies"
        count={bodies.length}
        all={all}
        of_found={(found) => <Found viewer={viewer} found={found} />}
        many_at_once={{
          change: (labels, what) => change_bodies(viewer, labels, what),
          show_only: (labels) => show_only(viewer, labels),
          show_all: () => show_all_bodies(viewer),
          go_there: (labels) => void go_to_labels(viewer, labels),
        }}
      />
    </>
  );
}
