// Grids that the page reads by itself: named in its own address ("?grid=https://..."), or dropped on it. The module that does it is loaded when the first of them is there.
import module_address from "virtual:module";
import { say } from "./base/messages";
import type { LocalGrids } from "./module/local";
import { ask_again } from "./server/connection";

// Whether this page was built with the module.
const can_read_files = module_address !== null;
export const addresses = (): string[] => new URLSearchParams(location.search).getAll("grid");

let local: Promise<LocalGrids> | null = null;
// `alone`: no server is asked for other grids.
const local_grids = (alone: boolean) => (local ??= import("./module/local").then(({ LocalGrids }) => new LocalGrids(alone)));

export async function open_addresses(): Promise<void> {
  const grids = await local_grids(true);
  const { HttpSource } = await import("./module/sources");
  for (const address of addresses()) {
    // What is no address is said in the list, too.
    await grids.add(async () => HttpSource.open(new URL(address, location.href)), address.split(/[?#]/)[0]!.split("/").pop() || address);
  }
}

// Opens the last one of those that can be read.
export async function open_files(files: Iterable<File>): Promise<void> {
  const grids = await local_grids(false);
  const { FileSource } = await import("./module/sources");
  let last: string | null = null;
  for (const file of files) {
    const id = await grids.add(async () => new FileSource(file, file.name), file.name);
    last = id ?? last;
    if (id === null) say(`${file.name} can't be read`, "The list of grids says why.");
  }
  ask_again();
  if (last !== null) location.hash = `#g=${encodeURIComponent(last)}`;
}

// What is dropped anywhere on the page is opened. Nothing is uploaded.
export function watch_drops(): void {
  if (!can_read_files) return;
  const has_files = (event: DragEvent) => event.dataTransfer?.types.includes("Files") ?? false;
  document.addEventListener("dragover", (event) => has_files(event) && event.preventDefault());
  document.addEventListener("drop", (event) => {
    if (!has_files(event)) return;
    event.preventDefault();
    void open_files([...event.dataTransfer!.files]);
  });
}
