// Starts the page.
import { render } from "preact";
import { App } from "./app";
import { open_own_grids, watch_drops } from "./module/own_grids";

open_own_grids();
watch_drops();
const app = document.getElementById("app")!;
app.replaceChildren(); // what was said in case that this does not start
render(<App />, app);
