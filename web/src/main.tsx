// Starts the page.
import { render } from "preact";
import { App } from "./app";
import { open_own_grids, watch_drops } from "./module/own_grids";

open_own_grids();
watch_drops();
render(<App />, document.getElementById("app")!);
