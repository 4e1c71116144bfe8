// The buttons of a slice view that zoom. Their titles say what the wheel does here, which is not what it does in three dimensions. The tab key
// passes them by: the view itself, where it has just been, takes their keys.
import type { Viewer } from "../state/viewer";
import { ZOOM_STEP } from "../state/zoom";
import { Icon, type IconName } from "../widgets/icons";
import { fit, show_cells } from "./actions";

const WHEEL = "The wheel alone goes through the slices.";

export function ZoomButtons({ viewer, zoom }: { viewer: Viewer; zoom: (factor: number) => void }) {
  const button = (icon: IconName, label: string, title: string, click: () => void) => (
    <button tabIndex={-1} aria-label={label} title={title} onClick={click}>
      <Icon name={icon} />
    </button>
  );
  return (
    <div class="view-zoom" role="group" aria-label="Zoom">
      {button("plus", "Zoom in", `Zoom in (+, or ctrl and the wheel). ${WHEEL}`, () => zoom(ZOOM_STEP))}
      {button("minus", "Zoom out", `Zoom out (−, or ctrl and the wheel). ${WHEEL}`, () => zoom(1 / ZOOM_STEP))}
      {button("cells", "Single cells", "Single cells around the crosshair (1)", () => show_cells(viewer))}
      {button("whole", "Zoom to fit", "Zoom to fit: the whole grid (Home)", () => fit(viewer))}
    </div>
  );
}
