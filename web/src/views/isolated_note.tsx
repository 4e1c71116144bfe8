// Says what is shown in full while all else is faint, and is the way back.
import { isolated_text } from "../state/isolation";
import type { Viewer } from "../state/viewer";
import { Icon } from "../widgets/icons";

export function IsolatedNote({ viewer }: { viewer: Viewer }) {
  const isolated = viewer.isolated.value;
  const text = isolated && isolated_text(isolated.labels, (label) => viewer.labels[label]!.body || viewer.name_of(label), viewer.keeps_bodies);
  return (
    <div class="isolated-note" role="status">
      {isolated && (
        <p>
          <Icon name="target" />
          <span>Isolated:</span>
          <b title={text!}>{text}</b>
          <button title="Show everything as it was (Escape)" onClick={() => (viewer.isolated.value = null)}>
            Show all again
          </button>
        </p>
      )}
    </div>
  );
}
