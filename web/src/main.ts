// Starts the page. Grids that it reads by itself are opened first, and the list is asked for, while the rest of the page is still on its way.
import { open_own_grids } from "./module/own_grids";
import { ask_ahead } from "./server/api";

open_own_grids();
ask_ahead();
const { show } = await import("./app");
void show(document.getElementById("app")!);
