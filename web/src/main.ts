// Starts the page. Grids that it reads by itself are opened first, while the rest of the page is still on its way.
import { open_own_grids } from "./module/own_grids";

open_own_grids();
const { show } = await import("./app");
show(document.getElementById("app")!);
