// Which grids there are, and which one is open. The address says so: "#g=id..." opens a grid. Without a grid in the
// address the page lists the grids, or opens the grid if there is nothing else. From time to time it looks whether the
// file of the open grid is still the same.
import { batch, effect, signal } from "@preact/signals";
import type { GridSummary, UnreadableFile } from "./base/grid";
import { words_of } from "./base/messages";
import { ServerError, drop_complaints, grid_info, list_grids, note_damage, version_gone } from "./server/api";
import { connection, returned } from "./server/connection";
import { is_alone } from "./server/transport";
import { keep_ground } from "./state/ground";
import { names_a_place, show_what_there_is } from "./visits/first_view";
import { grid_in_address, keep_address, query_in_address, read_address } from "./state/permalink";
import { keep_to_one_view } from "./state/phone";
import { Viewer } from "./state/viewer";

export const grids = signal<readonly GridSummary[] | null>(null); // null while they are not known
export const unreadable = signal<readonly UnreadableFile[]>([]); // files beside them that can't be read
export const viewer = signal<Viewer | null>(null);
export const opening = signal<string | null>(null); // the grid that is being opened
export const trouble = signal<string | null>(null); // why nothing could be opened
export const stale = signal<"replaced" | "gone" | null>(null);

const LOOK_EVERY = 10000;
let stop_keeping = () => {};
let abort = new AbortController();

// `next`: what is done with the list before it is shown.
async function load_grids(next = () => {}): Promise<void> {
  const list = await list_grids();
  batch(() => {
    grids.value = list.grids;
    unreadable.value = list.unreadable;
    next();
  });
  const open = viewer.value;
  if (!open) return;
  const now = list.grids.find((g) => g.id === open.info.id);
  stale.value = !now ? "gone" : now.hash !== open.info.file.hash ? "replaced" : null;
  if (stale.value) drop_complaints();
}

function close(): void {
  abort.abort();
  abort = new AbortController();
  stop_keeping();
  stop_keeping = () => {};
  viewer.value = null;
  opening.value = null;
  trouble.value = null;
  stale.value = null;
  drop_complaints(); // about what was open
  document.title = "teracell";
}

async function open(id: string): Promise<void> {
  close();
  opening.value = id;
  const { signal } = abort;
  try {
    const info = await grid_info(id, signal);
    const next = new Viewer(info);
    read_address(next);
    viewer.value = next;
    document.title = `${info.id} – teracell`;
    if (!names_a_place(query_in_address())) void show_what_there_is(next, signal).catch(() => {}); // lists say what is wrong
    const stops = [keep_to_one_view(next), keep_address(next), keep_ground(next)];
    stop_keeping = () => stops.forEach((stop) => stop());
  } catch (error) {
    if (signal.aborted) return;
    const none = error instanceof ServerError && error.status === 404;
    const known = none ? (await list_grids(signal).catch(() => null))?.unreadable.find((file) => file.id === id) : undefined;
    if (signal.aborted) return;
    trouble.value = none && !known ? `There is no grid “${id}” here.` : `“${id}” can't be opened: ${known?.error ?? words_of(error)}`;
  }
  opening.value = null;
}

// Does what the address says. If it names the grid that is open, the views move, and nothing is loaded again.
function follow_address(): void {
  const only = grids.value?.length === 1 && unreadable.value.length === 0 ? grids.value[0]!.id : null;
  const id = grid_in_address() ?? only;
  const now = viewer.value;
  if (id === null) {
    close();
    if (now) void look(); // it may have turned out to be damaged
  } else if (now && now.info.id === id) {
    now.reset();
    read_address(now);
  } else void open(id);
}

// Opens the grid as its file is now, at the same place.
export function reload(): void {
  if (is_alone()) location.reload();
  else if (viewer.value) void open(viewer.value.info.id);
}

export async function start_page(): Promise<void> {
  addEventListener("hashchange", follow_address);
  // A grid that the address names is opened at once, without waiting for the list.
  if (grid_in_address()) follow_address();
  await look(() => {
    if (!viewer.value && !opening.value && !trouble.value) follow_address();
  });
  setInterval(
    () => document.visibilityState === "visible" && connection.value.state === "there" && void (grids.value ? look() : look_again()),
    LOOK_EVERY,
  );
  // What the list says of the open grid, the grid says as well.
  effect(() => {
    const open = viewer.value;
    const damage = open && grids.value?.find((grid) => grid.id === open.info.id)?.damage;
    if (damage) note_damage(open.info.id, damage);
  });
  effect(() => {
    if (version_gone.value + returned.value > 0) void look_again();
  });
}

async function look(next?: () => void): Promise<void> {
  try {
    await load_grids(next);
  } catch (error) {
    if (!viewer.value && !opening.value && grids.value === null) trouble.value = `The list of grids can't be read: ${words_of(error)}`;
  }
}

async function look_again(): Promise<void> {
  const had_nothing = viewer.peek() === null;
  await look(() => {
    if (had_nothing && viewer.peek() === null) follow_address();
  });
}
