// The three columns through a cell as bars. They are fetched when the cell stands still.
import { useState } from "preact/hooks";
import { FRAMES } from "../base/axis";
import { AXES, AXIS_NAMES, type AxisIndex, type Column, type Index3, for_axes } from "../base/grid";
import { use_answer, use_settled } from "../server/answer";
import type { Viewer } from "../state/viewer";
import { CopyButton } from "../widgets/copy";
import { ProfileBar } from "./profile_bar";
import { run_at, run_text, runs_csv } from "./runs";

export interface ProfilesAnswer {
  columns: readonly (Column | null)[];
  material: number | null; // of the cell
  complete: boolean; // whether all columns are those of the cell; while it moves, earlier ones stay
  error: string | null;
}

export const SETTLED = 120; // milliseconds

export function use_profiles(viewer: Viewer, cell: Index3): ProfilesAnswer {
  const wanted = for_axes((d) => viewer.address.column(d, cell[FRAMES[d].u], cell[FRAMES[d].v]));
  const settled = use_settled(wanted.join("\n"), SETTLED).split("\n");
  const answers = for_axes((d) => use_answer<Column>(viewer.after_slices(settled[d]!)));
  // A column along d stays the same while the cell moves along d.
  const fresh = AXES.find((d) => answers[d]!.path === wanted[d] && answers[d]!.value);
  const runs = fresh === undefined ? null : answers[fresh]!.value!.runs;
  return {
    columns: answers.map((a) => a.value),
    material: runs ? runs[run_at(runs, cell[fresh!])]!.material : null,
    complete: AXES.every((d) => answers[d]!.path === wanted[d]),
    error: answers.find((a) => a.error)?.error ?? null,
  };
}

export function Profiles({ viewer, cell, profiles }: { viewer: Viewer; cell: Index3; profiles: ProfilesAnswer }) {
  const [pointed, set_pointed] = useState<{ axis: AxisIndex; run: number } | null>(null);
  const run = pointed && profiles.columns[pointed.axis]?.runs[pointed.run];
  const columns = profiles.columns.filter((c) => c !== null);
  return (
    <section class="dock-part profiles" aria-label="Columns through the cell">
      <h2>
        <span>
          Columns<span class="profile-of"> through the {viewer.pinned.value ? "pinned cell" : "crosshair"}</span>
        </span>
        <span class="profile-text" aria-live="off" title={run ? undefined : (profiles.error ?? undefined)}>
          {run ? run_text(run, viewer.axes[pointed.axis], viewer.units) : profiles.error}
        </span>
        <span class="dock-actions">
          <CopyButton what="the runs of the three columns as CSV" text={() => runs_csv(columns, viewer.info.units)} disabled={!profiles.complete} />
        </span>
      </h2>
      {AXES.map((d) => (
        <div class={`profile axis-${AXIS_NAMES[d]}`} key={d}>
          <span class="profile-axis">{AXIS_NAMES[d]}</span>
          <ProfileBar
            viewer={viewer}
            axis={d}
            cell={cell}
            column={profiles.columns[d] ?? null}
            point_at={(n) => set_pointed(n === null ? null : { axis: d, run: n })}
          />
        </div>
      ))}
    </section>
  );
}
