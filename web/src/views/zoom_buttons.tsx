// The buttons of a slice view that zoom. Their titles say what the wheel does here, which is not what it does in three dimensions. The tab key
// passes them by: the view itself, where it has just been, takes their keys.
import type { Viewer } from "../state/viewer";
import { ZOOM_STEP } from "../state/zoom";
import { fit, show_cells } from "./actions";

const WHEEL = "The wheel alone goes through the slices.";

export function ZoomButtons({ viewer, zoom }: { viewer: Viewer; zoom: (factor: number) => void }) {
  const button = (label: string, title: string, path: string, click: () => void) => (
    <button tabIndex={-1} aria-label={label} title={title} onClick={click}>
      <svg viewBox="0 0 16 16" width="16" height="16" aria-hidden="true" fill="none" stroke="currentColor" stroke-width="1.3">
        <path d={path} />
      </svg>
    </button>
  );
  return (
    <div class="view-zoom" role="group" aria-label="Zoom">
      {button("Zoom in", `Zoom in (+, or ctrl and the wheel). ${WHEEL}`, "M8 3.5v9M3.5 8h9", () => zoom(ZOOM_STEP))}
      {button("Zoom out", `Zoom out (−, or ctrl and the wheel). ${WHEEL}`, "M3.5 8h9", () => zoom(1 / ZOOM_STEP))}
      {button("Single cells", "Single cells around the crosshair (1)", "M2.5 2.5h11v11h-11zM6.2 2.5v11M9.8 2.5v11M2.5 6.2h11M2.5 9.8h11", () => show_cells(viewer))}
      {button("Zoom to fit", "Zoom to fit: the whole grid (Home)", "M2 8 8 2.5 14 8M4 6.8V13h8V6.8", () => fit(viewer))}
    </div>
  );
}
