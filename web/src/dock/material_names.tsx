// The material of a cell, or the set of materials in a coarse cell, with their colours. A dash while it is not known.
import type { Viewer } from "../state/viewer";
import { Swatch } from "../widgets/swatch";

export function MaterialNames({ viewer, ids }: { viewer: Viewer; ids: readonly number[] | null }) {
  if (!ids) return <span class="faint">–</span>;
  const names = ids.map((id) => viewer.info.materials[id]?.name ?? String(id));
  return (
    <span class="material-names" title={ids.length > 1 ? `mixed: ${names.join(", ")}` : names[0]}>
      {ids.length > 1 && <span class="faint">mixed:</span>}
      {ids.map((id, n) => (
        <span key={id} class="material-name">
          <Swatch look={viewer.looks.value[id]} />
          {names[n]}
        </span>
      ))}
    </span>
  );
}
