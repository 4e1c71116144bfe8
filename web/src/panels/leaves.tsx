// The grid refined to an octree: how, drawn in the slices or not, how many leaves it has, and the command that writes it.
import { signal } from "@preact/signals";
import { useState } from "preact/hooks";
import { grouped, noun, percent, product, significant } from "../base/format";
import { AXES, type LeafCount, type Refinement } from "../base/grid";
import { COARSEST, MOST_LAYERS, slabs, sum_of_counts } from "../base/refinement";
import { quoted } from "../base/shell";
import { get_json } from "../server/api";
import { use_answer } from "../server/answer";
import type { Viewer } from "../state/viewer";
import { color_of_level } from "../views/drawing/leaf_lines";
import { CodeLine } from "../widgets/copy";
import { Swatch } from "../widgets/swatch";

const MANY = 2e10; // cells of a grid whose leaves are not counted until somebody asks for it

function NumberField({ label, value, min, max, set }: { label: string; value: number; min: number; max: number; set: (value: number) => void }) {
  const change = (field: HTMLInputElement) => {
    const typed = Math.round(Number(field.value));
    if (field.value.trim() && Number.isFinite(typed)) set(Math.min(Math.max(typed, min), max));
    field.value = String(value);
  };
  return <input class="number-input" type="number" aria-label={label} min={min} max={max} value={value} onChange={(e) => change(e.currentTarget)} />;
}

// The edges of a leaf, which on a graded axis are of different lengths.
function edges(viewer: Viewer, level: number): string {
  if (viewer.info.grid.axes.some(({ type }) => type === "graded")) return "";
  const lengths = [...new Set(AXES.map((d) => significant(viewer.axes[d].width(0) * 2 ** level, 4)))];
  return `${lengths.join(" × ")} ${viewer.units}`;
}

// The levels, whose colours the slices have, and how many leaves there are of each where that is known.
function Levels({ viewer, coarsest, count }: { viewer: Viewer; coarsest: number; count: LeafCount | null }) {
  const leaves = (level: number) => count?.leaves.reduce((sum, row) => sum + (row.level === level ? row.leaves : 0), 0);
  return (
    <table class="stats">
      <thead>
        <tr>
          <th scope="col">level</th>
          <th scope="col">cells wide</th>
          <th scope="col">edges</th>
          <th scope="col">leaves</th>
        </tr>
      </thead>
      <tbody>
        {Array.from({ length: coarsest + 1 }, (_, level) => (
          <tr key={level}>
            <th scope="row">
              <span class="swatch" style={{ background: `rgb(${color_of_level(level).join(" ")})` }} aria-hidden="true" />
              {level}
            </th>
            <td>{grouped(2 ** level)}</td>
            <td>{edges(viewer, level)}</td>
            <td>{count ? grouped(leaves(level)!) : "–"}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function Counted({ viewer, count }: { viewer: Viewer; count: LeafCount }) {
  const cells = product(viewer.cells);
  const materials = new Map<string, number>();
  for (const { material, leaves } of count.leaves) materials.set(material, (materials.get(material) ?? 0) + leaves);
  return (
    <>
      <p>
        <b>{grouped(count.total)}</b> {noun(count.total, "leaf", "leaves")} for {grouped(cells)} {noun(cells, "cell")}{" "}
        <span class="faint nowrap">({percent(count.total / Number(cells))})</span>
      </p>
      <table class="stats">
        <thead>
          <tr>
            <th scope="col">material</th>
            <th scope="col">leaves</th>
            <th scope="col">share</th>
          </tr>
        </thead>
        <tbody>
          {[...materials].map(([name, leaves]) => (
            <tr key={name}>
              <th scope="row">
                <Swatch look={viewer.looks.value[viewer.info.materials.findIndex((m) => m.name === name)]} />
                <span title={name}>{name}</span>
              </th>
              <td>{grouped(leaves)}</td>
              <td>{percent(leaves / count.total)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </>
  );
}

// Slab by slab, so that one sees how far it is, and so that it ends when nobody waits any more.
function Count({ viewer, refinement }: { viewer: Viewer; refinement: Refinement }) {
  const many = product(viewer.cells) > MANY;
  const [asked, set_asked] = useState(!many);
  const [done] = useState(() => signal(0));
  const count_all = async (_: string, abort: AbortSignal): Promise<LeafCount> => {
    const boxes = slabs(viewer.cells, refinement.coarsest);
    const counts: LeafCount[] = [];
    for (const box of boxes) {
      done.value = counts.length / boxes.length;
      counts.push(await get_json<LeafCount>(viewer.address.leaf_count(refinement, box), abort));
    }
    done.value = 1;
    return sum_of_counts(counts);
  };
  const path = viewer.address.leaf_count(refinement, [0, 0, 0, ...viewer.cells]);
  const answer = use_answer<LeafCount>(asked ? path : null, count_all);
  const count = answer.path === path ? answer.value : null;
  return (
    <>
      <Levels viewer={viewer} coarsest={refinement.coarsest} count={count} />
      {!asked && (
        <div class="toolbar">
          <button class="button" onClick={() => set_asked(true)}>
            Count the leaves
          </button>
          <span class="note">In a grid of this size it takes minutes.</span>
        </div>
      )}
      {answer.error && (
        <p class="problem" role="alert">
          {answer.error}
        </p>
      )}
      {asked && !answer.error && !count && (
        <p class="note" role="status">
          Counting the leaves … {percent(done.value)}
        </p>
      )}
      {count && <Counted viewer={viewer} count={count} />}
    </>
  );
}

export function LeavesPanel({ viewer }: { viewer: Viewer }) {
  const refinement = viewer.refinement.value;
  const { coarsest, layers, want } = refinement;
  const set = (change: Partial<Refinement>) => (viewer.refinement.value = { ...viewer.refinement.value, ...change });
  const command = (name: string) => `teracell ${name} ${quoted(`${viewer.info.id}.tcell`)}`;
  const refined = ` --refine ${coarsest},${layers}${want ? ` --want ${quoted(want)}` : ""}`;
  return (
    <section>
      <h3>Refined grid</h3>
      <p class="note">
        An octree over the cells: fine where materials meet, coarse away from there. Nothing is written until you export it.
      </p>
      <div class="leaf-fields">
        <label>
          <span>coarsest level</span>
          <NumberField label="Coarsest level" value={coarsest} min={0} max={COARSEST} set={(value) => set({ coarsest: value })} />
          <span class="faint">{grouped(2 ** coarsest)} cells wide</span>
        </label>
        <label>
          <span>layers</span>
          <NumberField label="Layers of cells of each level" value={layers} min={1} max={MOST_LAYERS} set={(value) => set({ layers: value })} />
          <span class="faint">of cells around what is finer</span>
        </label>
        <label>
          <span>fine at</span>
          <input
            class="text-input"
            aria-label="What is fine"
            placeholder="interface=0"
            spellcheck={false}
            value={want}
            onChange={(e) => set({ want: e.currentTarget.value.trim() })}
          />
        </label>
      </div>
      <details>
        <summary>What can be fine</summary>
        <p class="note">
          One or more, joined by commas; the finest counts. 0 stands for the level: single cells. <code>interface=0</code>: where materials meet.{" "}
          <code>material:NAME=0</code>: where this one meets others. <code>patch:NAME=0</code>: at a patch, in grids with links.{" "}
          <code>inside:NAME=0</code>: all of a material. <code>box:X0,Y0,Z0,X1,Y1,Z1=0</code>: all cells of a box.
        </p>
      </details>
      <label class="leaf-switch">
        <input type="checkbox" checked={viewer.show_leaves.value} onChange={(e) => (viewer.show_leaves.value = e.currentTarget.checked)} />
        Draw the leaves in the slices <kbd aria-hidden="true">r</kbd>
      </label>
      <Count key={JSON.stringify(refinement)} viewer={viewer} refinement={refinement} />
      <h4>Write it</h4>
      <CodeLine class="code-line" text={`${command("export")} --format openfoam${refined} -o case`} what="the command that writes a mesh for OpenFOAM" />
      <CodeLine
        class="code-line"
        text={`${command("slice")} --axis z --index ${viewer.slice[2].value}${refined} -o leaves.png`}
        what="the command that draws a slice with its leaves"
      />
    </section>
  );
}
