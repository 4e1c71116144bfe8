// What bundle.mjs bundles: Neuroglancer as it is, with its viewer within the test's reach.
import "neuroglancer";
import { setupDefaultViewer } from "neuroglancer/unstable/ui/default_viewer_setup.js";

window.viewer = setupDefaultViewer();
