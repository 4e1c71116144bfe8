// The materials: how they look, and how much of the grid they are, exactly.
import { useState } from "preact/hooks";
import type { MaterialStats, Stats } from "../api";
import { use_answer } from "../answer";
import { grouped, percent, product, significant } from "../format";
import { Icon } from "../icons";
import { type MaterialLook, css_color } from "../materials";
import type { Viewer } from "../viewer";
import { all_distinct, with_colors_of, with_distinct_colors } from "./palette";
import { BoxText, GoThere } from "./places";

const MANY = 12; // from here on a filter helps
const MOST = 200; // shown at once

const hex = (look: MaterialLook) => `#${look.color.map((c) => c.toString(16).padStart(2, "0")).join("")}`;

const same_look = (a: MaterialLook, b: MaterialLook) => a.visible === b.visible && a.opacity === b.opacity && hex(a) === hex(b);

export const cells_of = (m: MaterialStats): string => grouped(m.cells_text ?? m.cells);

function change(viewer: Viewer, id: number, what: Partial<MaterialLook>): void {
  viewer.looks.value = viewer.looks.value.map((look, n) => (n === id ? { ...look, ...what } : look));
}

// Shows this one alone; all of them when it already is.
function solo(viewer: Viewer, id: number): void {
  const alone = is_solo(viewer, id);
  viewer.looks.value = viewer.looks.value.map((look, n) => ({ ...look, visible: alone || n === id }));
}
const is_solo = (viewer: Viewer, id: number) => viewer.looks.value.every((look, n) => look.visible === (n === id));

function recolour(viewer: Viewer, id: number, text: string): void {
  const channel = (at: number) => Number.parseInt(text.slice(at, at + 2), 16);
  change(viewer, id, { color: [channel(1), channel(3), channel(5)] });
}

function MaterialCard({ viewer, id, stats, all }: { viewer: Viewer; id: number; stats: MaterialStats | null; all: number }) {
  const look = viewer.looks.value[id]!;
  const { name } = viewer.info.materials[id]!;
  const share = stats ? stats.cells / all : 0;
  const volume = stats ? `${significant(stats.volume, 6)} ${viewer.info.units}³` : "";
  return (
    <li class={`material ${look.visible ? "" : "is-hidden"}`}>
      <div class="material-head">
        <input type="color" title={`Colour of ${name}`} aria-label={`Colour of ${name}`} value={hex(look)} style={{ "--opacity": look.opacity }} onInput={(e) => recolour(viewer, id, e.currentTarget.value)} />
        <span class="material-title" title={name}>
          {name}
          {id === 0 && <span class="faint"> background</span>}
        </span>
        <input
          type="range"
          min={0}
          max={100}
          value={Math.round(100 * look.opacity)}
          title={`Opacity ${Math.round(100 * look.opacity)} %`}
          aria-label={`Opacity of ${name}`}
          aria-valuetext={`${Math.round(100 * look.opacity)} %`}
          onInput={(e) => change(viewer, id, { opacity: Number(e.currentTarget.value) / 100 })}
        />
        <button class="icon-button" title={look.visible ? "Hide" : "Show"} aria-label={`Show ${name}`} aria-pressed={look.visible} onClick={() => change(viewer, id, { visible: !look.visible })}>
          <Icon name={look.visible ? "eye" : "hidden"} />
        </button>
        <button class="icon-button" title="Only this one" aria-label={`Only ${name}`} aria-pressed={is_solo(viewer, id)} onClick={() => solo(viewer, id)}>
          <Icon name="solo" />
        </button>
      </div>
      <div class="share-bar" aria-hidden="true">
        <span style={{ width: `${100 * share}%`, background: look.opacity > 0 ? css_color(look) : "var(--line-strong)" }} />
      </div>
      <dl class="numbers">
        <div>
          <dt>cells</dt>
          <dd>
            {stats ? cells_of(stats) : "…"} <span class="share">{stats ? percent(share) : ""}</span>
          </dd>
        </div>
        <div>
          <dt>volume</dt>
          <dd>{stats ? volume : "…"}</dd>
        </div>
      </dl>
      {stats?.box ? (
        <details class="material-box">
          <summary>Bounding box</summary>
          <BoxText viewer={viewer} box={stats.box} />
          <GoThere what={name} go={() => viewer.go_to_box(stats.box!)} />
        </details>
      ) : (
        stats && <p class="note">no cell of it</p>
      )}
    </li>
  );
}

export function MaterialsPanel({ viewer }: { viewer: Viewer }) {
  const stats = use_answer<Stats>(viewer.address.stats());
  const [filter, set_filter] = useState("");
  const { materials } = viewer.info;
  const all = Number(product(viewer.cells));
  const looks = viewer.looks.value;
  const found = materials.filter((m) => m.name.toLowerCase().includes(filter.trim().toLowerCase()));
  const everything_visible = looks.every((l) => l.visible);
  const own_colors_distinct = all_distinct(viewer.standard_looks);
  const distinct = all_distinct(looks);
  return (
    <>
      <div class="toolbar">
        <button class="button" disabled={everything_visible} onClick={() => (viewer.looks.value = looks.map((l) => ({ ...l, visible: true })))}>
          Show all
        </button>
        {!own_colors_distinct && (
          <button
            class="button"
            aria-pressed={distinct}
            title="Colours that stay apart for colour-blind eyes, instead of the scene's own"
            onClick={() => (viewer.looks.value = distinct ? with_colors_of(looks, viewer.standard_looks) : with_distinct_colors(looks))}
          >
            Distinct colours
          </button>
        )}
        <span class="spacer" />
        <button class="button" disabled={looks.every((look, id) => same_look(look, viewer.standard_looks[id]!))} title="Colours, opacity and visibility as they were" onClick={() => (viewer.looks.value = viewer.standard_looks)}>
          Reset
        </button>
      </div>
      {materials.length > MANY && (
        <input class="text-input" type="search" placeholder={`Filter ${grouped(materials.length)} materials`} aria-label="Filter materials by name" value={filter} onInput={(e) => set_filter(e.currentTarget.value)} />
      )}
      {stats.error && <p class="problem">The cells can't be counted: {stats.error}</p>}
      <ul class="materials">
        {found.slice(0, MOST).map((m) => (
          <MaterialCard key={m.id} viewer={viewer} id={m.id} stats={stats.value?.materials[m.id] ?? null} all={all} />
        ))}
      </ul>
      {found.length > MOST && <p class="note">{grouped(found.length - MOST)} more: filter by name</p>}
      <dl class="numbers total">
        <div>
          <dt>all cells</dt>
          <dd>{grouped(product(viewer.cells))}</dd>
        </div>
      </dl>
    </>
  );
}
