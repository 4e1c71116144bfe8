// Says what is shown in full while all else is faint, and is the way back.
import { isolated_text } from "../state/isolation";
import type { Viewer } from "../state/viewer";

export function IsolatedNote({ viewer }: { viewer: Viewer }) {
  const isolated = viewer.isolated.value;
  const text = isolated && isolated_text(isolated, { labels: viewer.labels, overlaps: viewer.info.report.overlaps }, (label) => viewer.labels[label]!.body || viewer.name_of(label), viewer.keeps_bodies);
  return (
    <div class="isolated-note" role="status">
      {isolated && (
        <p>
          <span title={text!}>
            <svg viewBox="0 0 16 16" width="16" height="16" aria-hidden="true" fill="none" stroke="currentColor" stroke-width="1.5" stroke-linecap="round">
              <path d="M8 1.5v4M8 10.5v4M1.5 8h4M10.5 8h4M8 12a4 4 0 1 0 0-8 4 4 0 0 0 0 8z" />
            </svg>
            Isolated: <b>{text}</b>
          </span>
          <button title="Show everything as it was (Escape)" onClick={() => (viewer.isolated.value = null)}>
            Show all again
          </button>
        </p>
      )}
    </div>
  );
}
