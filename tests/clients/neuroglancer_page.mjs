// bundle.mjs bundles this page: Neuroglancer unchanged, with its viewer as a global for the test.
import "neuroglancer";
import { setupDefaultViewer } from "neuroglancer/unstable/ui/default_viewer_setup.js";

window.viewer = setupDefaultViewer();
