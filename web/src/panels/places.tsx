// What several panels show: boxes of cells, and buttons that look at places.
import { coordinate, grouped } from "../base/format";
import { AXES, AXIS_NAMES } from "../base/grid";
import type { Box, Viewer } from "../state/viewer";
import { Icon } from "../widgets/icons";

export function GoThere({ what, go, text = "Go there" }: { what: string; go: () => void; text?: string }) {
  return (
    <button class="button small" title={`Look at ${what}`} aria-label={`${text}: ${what}`} onClick={go}>
      <Icon name="target" />
      {text}
    </button>
  );
}

// A point's coordinates, as fine as the cells there.
export function point_text(viewer: Viewer, point: readonly number[]): string {
  return AXES.map((d) => coordinate(point[d]!, viewer.axes[d].width(viewer.axes[d].cell_at(point[d]!)))).join(", ");
}

// The first and the last cell of a box along each axis, and the coordinates between which they lie.
export function BoxText({ viewer, box }: { viewer: Viewer; box: Box }) {
  return (
    <table class="box-text">
      <tbody>
        {AXES.map((d) => {
          const axis = viewer.axes[d];
          const [low, high] = [box[d], box[d + 3]!];
          return (
            <tr key={d} class={`axis-${AXIS_NAMES[d]}`}>
              <th scope="row">{AXIS_NAMES[d]}</th>
              <td>
                {grouped(low)} – {grouped(high - 1)}
              </td>
              <td>
                {coordinate(axis.plane(low), axis.width(low))} … {coordinate(axis.plane(high), axis.width(high - 1))} {viewer.units}
              </td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}
