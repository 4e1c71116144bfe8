// Which page: one grid in the viewer, or the list of grids.
import { render } from "preact";
import { App } from "./app";

render(<App />, document.getElementById("app")!);
