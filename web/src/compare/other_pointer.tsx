// Where the pointer would be in the other picture.
import type { AxisIndex } from "../base/grid";
import type { Pair } from "./pair";

export function OtherPointer({ pair, axis }: { pair: Pair; axis: AxisIndex }) {
  const { left, right } = pair;
  // These signals change with the pointer.
  const over_left = left.viewer.hover.value !== null;
  const over_right = right.viewer.hover.value !== null;
  if (over_left === over_right) return null;
  const [from, to] = (over_left ? [left, right] : [right, left]).map((stage) => stage.views[axis]) as [typeof left.views[0], typeof left.views[0]];
  const [body, host] = [to.cells.parentElement, to.cells.closest(".views")];
  if (!from.pointer || !body || !host) return null;
  const [box, outer] = [body.getBoundingClientRect(), host.getBoundingClientRect()];
  const [x, y] = [from.pointer.x + box.left - outer.left, from.pointer.y + box.top - outer.top];
  return <span class="other-pointer" aria-hidden="true" style={{ left: `${x}px`, top: `${y}px` }} />;
}
