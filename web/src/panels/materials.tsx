// The materials: how they look, and exactly how much of the grid they fill.
import { useState } from "preact/hooks";
import { grouped, percent, product, significant } from "../base/format";
import type { MaterialStats, Stats } from "../base/grid";
import { type MaterialLook, css_color, hex_color, same_look } from "../base/materials";
import { use_answer } from "../server/answer";
import type { Viewer } from "../state/viewer";
import { Fact } from "../widgets/fact";
import { Icon } from "../widgets/icons";
import { FirstOf } from "./first_of";
import { all_distinct, with_colors_of, with_distinct_colors } from "./palette";
import { BoxText, GoThere } from "./places";

const MANY = 12; // with more materials there is a filter, and each material is one line, which can be opened
const STEP = 100; // materials that are shown at once

export const cells_of = (m: MaterialStats): string => grouped(m.cells_text ?? m.cells);

function change(viewer: Viewer, id: number, what: Partial<MaterialLook>): void {
  viewer.looks.value = viewer.looks.value.map((look, n) => (n === id ? { ...look, ...what } : look));
}

// Shows this material alone, or all of them when it is alone already.
function solo(viewer: Viewer, id: number): void {
  const alone = is_solo(viewer, id);
  viewer.looks.value = viewer.looks.value.map((look, n) => ({ ...look, visible: alone || n === id }));
}
const is_solo = (viewer: Viewer, id: number) => viewer.looks.value.every((look, n) => look.visible === (n === id));

function recolour(viewer: Viewer, id: number, text: string): void {
  const channel = (at: number) => Number.parseInt(text.slice(at, at + 2), 16);
  change(viewer, id, { color: [channel(1), channel(3), channel(5)] });
}

interface CardProps {
  viewer: Viewer;
  id: number;
  stats: MaterialStats | null;
  all: number; // cells of the grid
}

function Opacity({ viewer, id }: { viewer: Viewer; id: number }) {
  const look = viewer.looks.value[id]!;
  const percent_of = Math.round(100 * look.opacity);
  return (
    <input
      type="range"
      min={0}
      max={100}
      value={percent_of}
      title={`Opacity ${percent_of} %`}
      aria-label={`Opacity of ${viewer.info.materials[id]!.name}`}
      aria-valuetext={`${percent_of} %`}
      onInput={(e) => change(viewer, id, { opacity: Number(e.currentTarget.value) / 100 })}
    />
  );
}

function Amount({ viewer, id, stats, all }: CardProps) {
  const look = viewer.looks.value[id]!;
  const share = stats ? stats.cells / all : 0;
  return (
    <>
      <div class="share-bar" aria-hidden="true">
        <span style={{ width: `${100 * share}%`, background: look.opacity > 0 ? css_color(look) : "var(--line-strong)" }} />
      </div>
      <dl class="numbers">
        <Fact name="cells">
          {stats ? cells_of(stats) : "…"} <span class="share">{stats ? percent(share) : ""}</span>
        </Fact>
        <Fact name="volume">{stats ? `${significant(stats.volume, 6)} ${viewer.units}³` : "…"}</Fact>
      </dl>
      {stats?.box ? (
        <details class="material-box">
          <summary>Bounding box</summary>
          <BoxText viewer={viewer} box={stats.box} />
          <GoThere what={viewer.info.materials[id]!.name} go={() => viewer.go_to_box(stats.box!)} />
        </details>
      ) : (
        stats && <p class="note">It owns no cell.</p>
      )}
    </>
  );
}

// With `short`, it is one line until it is opened.
function MaterialCard({ short, ...props }: CardProps & { short: boolean }) {
  const { viewer, id, stats, all } = props;
  const [opened, set_opened] = useState(false);
  const look = viewer.looks.value[id]!;
  const { name } = viewer.info.materials[id]!;
  const whole = !short || opened;
  const title = (
    <>
      {name}
      {id === 0 && <span class="faint"> background</span>}
    </>
  );
  return (
    <li class={`material ${look.visible ? "" : "is-hidden"} ${short ? "is-short" : ""}`}>
      <div class="material-head">
        <input
          type="color"
          title={`Colour of ${name}`}
          aria-label={`Colour of ${name}`}
          value={hex_color(look)}
          style={{ "--opacity": look.opacity }}
          onInput={(e) => recolour(viewer, id, e.currentTarget.value)}
        />
        {short ? (
          <button class="material-title" title={name} aria-expanded={opened} onClick={() => set_opened(!opened)}>
            {title}
          </button>
        ) : (
          <span class="material-title" title={name}>
            {title}
          </span>
        )}
        {whole ? <Opacity viewer={viewer} id={id} /> : <span class="share">{stats ? percent(stats.cells / all) : "…"}</span>}
        <button
          class="icon-button"
          title={look.visible ? "Hide" : "Show"}
          aria-label={`Show ${name}`}
          aria-pressed={look.visible}
          onClick={() => change(viewer, id, { visible: !look.visible })}
        >
          <Icon name={look.visible ? "eye" : "hidden"} />
        </button>
        <button
          class="icon-button"
          title="Show only this material"
          aria-label={`Only ${name}`}
          aria-pressed={is_solo(viewer, id)}
          onClick={() => solo(viewer, id)}
        >
          <Icon name="solo" />
        </button>
      </div>
      {whole && <Amount {...props} />}
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
      {materials.length > MANY && (
        <input
          class="text-input"
          type="search"
          placeholder={`Filter ${grouped(materials.length)} materials`}
          aria-label="Filter materials by name"
          value={filter}
          onInput={(e) => set_filter(e.currentTarget.value)}
        />
      )}
      {stats.error && <p class="problem">The cells can't be counted: {stats.error}</p>}
      <ul class="materials">
        <FirstOf list={found} step={STEP}>
          {(m) => (
            <MaterialCard
              key={m.id}
              short={materials.length > MANY}
              viewer={viewer}
              id={m.id}
              stats={stats.value?.materials[m.id] ?? null}
              all={all}
            />
          )}
        </FirstOf>
      </ul>
      {found.length === 0 && <p class="note">The name of no material contains this text.</p>}
      <dl class="numbers total">
        <Fact name="all cells">{grouped(product(viewer.cells))}</Fact>
      </dl>
    </>
  );
}
