// The dock below the views, at a fixed height: what is under the pointer, where the crosshair or the pinned cell is,
// and the materials along the three columns through it.
import { useEffect } from "preact/hooks";
import { coordinate, grouped } from "../base/format";
import { AXES, AXIS_NAMES, type CellAnswer, type Index3 } from "../base/grid";
import { use_answer, use_settled } from "../server/answer";
import { cell_text, coordinates_text } from "../state/place_text";
import type { Viewer } from "../state/viewer";
import { CopyButton } from "../widgets/copy";
import { IconButton } from "../widgets/icons";
import { LabelNames } from "./label_names";
import { PlaneText, Shares, use_shares } from "./shares";
import { Profiles, SETTLED, use_profiles } from "./profiles";

// The indices of a cell and the coordinates of a point in it, one line per axis.
function Place({ viewer, cell, point }: { viewer: Viewer; cell: Index3 | null; point?: readonly number[] }) {
  return (
    <table class="place">
      <tbody>
        {AXES.map((d) => {
          const axis = viewer.axes[d];
          const i = cell?.[d];
          return (
            <tr key={d} class={`axis-${AXIS_NAMES[d]}`}>
              <th scope="row">{AXIS_NAMES[d]}</th>
              <td class="index">{i === undefined ? "–" : grouped(i)}</td>
              <td class="coordinate">{i === undefined ? "" : coordinate(point?.[d] ?? axis.centre(i), axis.width(i))}</td>
              <td class="unit">{i === undefined ? "" : viewer.units}</td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

function Pointer({ viewer }: { viewer: Viewer }) {
  const hover = viewer.hover.value;
  const { shares, plane } = use_shares(viewer, hover?.cell ?? null);
  useEffect(() => {
    viewer.cut.value = hover && plane ? { cell: hover.cell, plane } : null;
  }, [plane]);
  return (
    <section class="dock-part dock-pointer" aria-label="Under the pointer">
      <h2>
        Pointer
        {plane && <PlaneText plane={plane} />}
      </h2>
      <Place viewer={viewer} cell={hover?.cell ?? null} {...(hover ? { point: hover.point } : {})} />
      <div class="dock-material">
        {shares ? <Shares viewer={viewer} shares={shares} /> : <LabelNames viewer={viewer} labels={hover?.labels ?? null} coarse={!!hover?.level} />}
      </div>
    </section>
  );
}

// The labels of a cell. Columns tell its material; where the file keeps bodies apart, the cell itself is asked for.
function use_labels(viewer: Viewer, cell: Index3, material: number | null): number[] | null {
  const address = use_settled(viewer.keeps_bodies ? viewer.address.cell(cell) : null, SETTLED);
  const answer = use_answer<CellAnswer>(viewer.after_slices(address));
  if (!viewer.keeps_bodies) return material === null ? null : [material];
  return answer.path === viewer.address.cell(cell) ? answer.value!.bodies!.map(({ label }) => label) : null;
}

export function Dock({ viewer }: { viewer: Viewer }) {
  const pinned = viewer.pinned.value;
  const cell = pinned ?? viewer.cell.value;
  const profiles = use_profiles(viewer, cell);
  const labels = use_labels(viewer, cell, profiles.material);
  const { shares } = use_shares(viewer, cell);
  return (
    <aside class="dock" aria-label="Read-out">
      <Pointer viewer={viewer} />
      <section class={`dock-part dock-cell ${pinned ? "is-pinned" : ""}`} aria-label={pinned ? "Pinned cell" : "Crosshair"}>
        <h2>
          <span class="dock-name">{pinned ? "Pinned" : "Crosshair"}</span>
          <span class="dock-actions">
            <CopyButton small label="cell" what="the place as a cell" text={cell_text(cell)} />
            <CopyButton small label={viewer.units} what={`the place in ${viewer.units}`} text={coordinates_text(viewer.axes, cell, viewer.info.units)} />
            {pinned ? (
              <>
                <IconButton class="small" icon="target" label="Look at the pinned cell" onClick={() => viewer.look_at_cell(pinned)} />
                <IconButton class="small" icon="close" label="Unpin the cell" onClick={() => (viewer.pinned.value = null)} />
              </>
            ) : (
              <IconButton class="small" icon="pin" label="Pin this cell" onClick={() => (viewer.pinned.value = [...cell])} />
            )}
          </span>
        </h2>
        <Place viewer={viewer} cell={cell} />
        <div class="dock-material">
          {shares ? <Shares viewer={viewer} shares={shares} /> : <LabelNames viewer={viewer} labels={labels} />}
        </div>
      </section>
      <Profiles viewer={viewer} cell={cell} profiles={profiles} />
    </aside>
  );
}
