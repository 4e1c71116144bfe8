// The materials: how they look, and exactly how much of the grid they fill.
import { batch } from "@preact/signals";
import { useMemo } from "preact/hooks";
import { grouped, product } from "../base/format";
import type { Report, Stats } from "../base/grid";
import { type MaterialLook, same_look } from "../base/materials";
import { use_stats } from "../visits/amounts";
import { go_to_labels } from "../visits/go_there";
import type { Viewer } from "../state/viewer";
import { Fact } from "../widgets/fact";
import type { Item } from "./look_card";
import { LookList } from "./look_list";
import type { ManyAtOnce } from "./look_tree";
import { all_distinct, with_colors_of, with_distinct_colors } from "./palette";

function many_at_once(viewer: Viewer): ManyAtOnce {
  const change = (of: (look: MaterialLook, id: number) => MaterialLook) => (viewer.looks.value = viewer.looks.value.map(of));
  // Who chooses what is seen wants to see that.
  const choose = (is_visible: (look: MaterialLook, id: number) => boolean) =>
    batch(() => {
      viewer.isolated.value = null;
      change((look, id) => ({ ...look, visible: is_visible(look, id) }));
    });
  return {
    change: (ids, { visible, ...what }) => {
      const wanted = new Set(ids);
      batch(() => {
        change((look, id) => (wanted.has(id) ? { ...look, ...what } : look));
        if (visible !== undefined) choose((look, id) => (wanted.has(id) ? visible : look.visible));
      });
    },
    show_only: (ids) => {
      const wanted = new Set(ids);
      choose((_, id) => wanted.has(id));
    },
    show_all: () => choose(() => true),
    go_there: (ids) => {
      const wanted = new Set(ids);
      void go_to_labels(viewer, viewer.labels.flatMap(({ material }, label) => (wanted.has(material) ? [label] : [])));
    },
  };
}

// The names of the bodies of each material.
export function bodies_by_material({ scene }: Report): ReadonlyMap<string, readonly string[]> {
  const names = new Map<string, string[]>();
  for (const { name, material } of scene?.bodies ?? []) names.set(material, [...(names.get(material) ?? []), name]);
  return names;
}

function items_of(viewer: Viewer, stats: Stats | null, bodies: ReadonlyMap<string, readonly string[]>): Item[] {
  const looks = viewer.looks.value;
  const visible = looks.flatMap((look, id) => (look.visible ? [id] : []));
  const many = many_at_once(viewer);
  return viewer.info.materials.map(({ id, name }) => {
    const alone = visible.length === 1 && visible[0] === id;
    return {
      id,
      name,
      beside: id === 0 ? "background" : "",
      bodies: bodies.get(name) ?? [],
      look: looks[id]!,
      alone,
      amount: stats?.materials[id] ?? null,
      change: (what) => many.change([id], what),
      show_alone: () => (alone ? many.show_all() : many.show_only([id])),
      go_there: () => many.go_there([id]),
    };
  });
}

export function MaterialsPanel({ viewer }: { viewer: Viewer }) {
  const stats = use_stats(viewer);
  const all = Number(product(viewer.cells));
  const looks = viewer.looks.value;
  const distinct = all_distinct(looks);
  const { report } = viewer.info;
  const bodies = useMemo(() => (viewer.keeps_bodies ? new Map() : bodies_by_material(report)), [viewer]);
  const one_look = !viewer.keeps_bodies && (report.scene ? [...bodies.values()].some((names) => names.length > 1) : report.bodies.length > 1);
  return (
    <>
      <div class="toolbar">
        <button
          class="button"
          disabled={looks.every((l) => l.visible)}
          onClick={many_at_once(viewer).show_all}
        >
          Show all
        </button>
        {!all_distinct(viewer.standard_looks) && (
          <button
            class="button"
            aria-pressed={distinct}
            title="Colours that colour-blind people can tell apart, instead of the scene's own"
            onClick={() => (viewer.looks.value = distinct ? with_colors_of(looks, viewer.standard_looks) : with_distinct_colors(looks))}
          >
            Distinct colours
          </button>
        )}
        <span class="spacer" />
        <button
          class="button"
          disabled={looks.every((look, id) => same_look(look, viewer.standard_looks[id]!))}
          title="Restore the original colours, opacity and visibility"
          onClick={() => (viewer.looks.value = viewer.standard_looks)}
        >
          Reset
        </button>
      </div>
      {one_look && (
        <p class="note">
          Bodies of one material are hidden, faded and coloured together. To have each alone, mesh with <code>"label_by": "body"</code> in the scene.
        </p>
      )}
      {stats.error && <p class="problem">The cells can't be counted: {stats.error}</p>}
      <LookList viewer={viewer} items={items_of(viewer, stats.value, bodies)} what="materials" all={all} many_at_once={many_at_once(viewer)} />
      <dl class="numbers total">
        <Fact name="all cells">{grouped(product(viewer.cells))}</Fact>
      </dl>
    </>
  );
}
