// What a cell is made of: its material or body, or the set of them in a coarse cell, with their colours. A dash while it
// is not known.
import { without_overlap } from "../base/grid";
import type { Viewer } from "../state/viewer";
import { Swatch } from "../widgets/swatch";

const MOST = 4; // bodies that are named; of more only the materials are

function entries_of(viewer: Viewer, labels: readonly number[]) {
  if (!viewer.keeps_bodies || labels.length <= MOST) return labels.map((label) => ({ name: viewer.name_of(label), look: viewer.label_looks.value[label] }));
  const materials = new Set(labels.map((label) => viewer.labels[label]!.material));
  return [...materials].map((id) => ({ name: viewer.info.materials[id]!.name, look: viewer.looks.value[id] }));
}

export function LabelNames({ viewer, labels: all, coarse = false }: { viewer: Viewer; labels: readonly number[] | null; coarse?: boolean }) {
  if (!all) return <span class="faint">–</span>;
  // Of several, what a body has alone and what lies in others as well are one.
  const labels = all.length === 1 ? all : [...new Set(all.map((label) => without_overlap(viewer.labels, label)))];
  if (labels.length === 0) return <span class="faint">can't be read{coarse && " at this zoom"}</span>;
  const entries = entries_of(viewer, labels);
  const mixed = labels.length > 1;
  return (
    <span class="material-names" title={`${mixed ? "mixed: " : ""}${entries.map(({ name }) => name).join(", ")}`}>
      {mixed && <span class="faint">{entries.length < labels.length ? `${labels.length} bodies of` : "mixed:"}</span>}
      {entries.map(({ name, look }) => (
        <span key={name} class="material-name">
          <Swatch look={look} />
          {name}
        </span>
      ))}
    </span>
  );
}
