// Grids that the page reads by itself: named in its address ("?grid=https://..."), in the page as it was written (held.ts), or given to
// it by the user. The module that does it is loaded when the first of them is there.
import { signal } from "@preact/signals";
import { say } from "../base/messages";
import { stem_of } from "../base/names";
import { ask_again } from "../server/connection";
import { list_grids } from "../server/api";
import { answer_by, be_alone, is_alone } from "../server/transport";
import { advice_for } from "./advice";
import { has_module, whole_page } from "./beside";
import { HeldSource, type ListedGrid, held_text, listed_grids } from "./held";
import { type Checked, LocalGrids } from "./local";
import type { Place, Source } from "./sources";

export const can_read_files = has_module;

const last_part = (address: string) => address.split(/[?#]/)[0]!.split("/").pop() || address;
const addressed = (address: string): ListedGrid => ({ name: last_part(address), address });

// Whether the address bar names grids in place of those that the page comes with.
export let asked_elsewhere = false;

// Those of the address bar, or else of the page; null: a server has the grids. "?grid=bust" of one that is served, or that the page has, is
// the same as "#g=bust".
function own_grids(): readonly ListedGrid[] | null {
  const listed = listed_grids();
  const asked = new URLSearchParams(location.search).getAll("grid").filter((text) => text !== "");
  // A served grid's address has a slash. In a page that lists grids, a file beside it has none.
  const is_name = (text: string) => (listed ? listed.some(({ name }) => stem_of(name) === stem_of(text)) : !text.includes("/"));
  if (asked.every(is_name)) {
    if (asked.length > 0) open_by_name(stem_of(asked[0]!));
    return listed;
  }
  asked_elsewhere = whole_page !== null; // a page that is one file may fetch nothing
  return asked_elsewhere ? asked.map(addressed) : listed;
}

function open_by_name(id: string): void {
  const state = new URLSearchParams(location.hash.slice(1));
  state.set("g", id);
  history.replaceState(null, "", `${location.pathname}#${state}`);
}

const held = new Map<number, Source>();

function place_of(grid: ListedGrid, number: number): Place {
  if ("bytes" in grid) {
    held.set(number, new HeldSource(number, grid.name, grid.bytes));
    return { kind: "page", grid: number, size: grid.bytes };
  }
  const url = URL.canParse(grid.address, location.href) ? new URL(grid.address, location.href) : null;
  if (!url || !/^https?:$/.test(url.protocol)) throw new Error(`expected the address of a .tcell file, such as https://host/g.tcell, found “${grid.address}”`);
  if (url.username || url.password) throw new Error(`“${grid.address}” has a name or a password in it, and browsers refuse that`);
  return { kind: "address", address: url.href, found: null };
}

function checked_of(grid: ListedGrid, number: number): Checked | null {
  if (grid.checked === undefined) return null;
  const text = async () => ("bytes" in grid ? held_text(`findings-${number}`) : (await fetch(grid.address.replace(/\.[^./]*$/, ".check.json"))).text());
  return { hash: grid.checked, text };
}

let local: LocalGrids | null = null;
function local_grids(): LocalGrids {
  if (local) return local;
  const grids = new LocalGrids(held);
  answer_by((before) => (path, options) => grids.answer(path, options, before));
  return (local = grids);
}

// Finds out whether there is a server. If not, the page opens its own grids, and what it asks for waits for them.
export function open_own_grids(): void {
  const own = own_grids();
  if (own === null) return;
  be_alone();
  const grids = local_grids();
  for (const [number, grid] of own.entries()) void grids.add(() => place_of(grid, number), grid.name, checked_of(grid, number));
}

// Opens the last one of those that can be read, and says what to do with the others. Nothing is uploaded.
export async function open_files(files: readonly File[]): Promise<void> {
  const perhaps = files.filter(({ name }) => {
    const advice = advice_for(name, can_read_files);
    if (advice) say(advice.text, advice);
    return !advice;
  });
  if (perhaps.length === 0) return;
  if (!can_read_files) return say(`${perhaps[0]!.name} is neither a grid nor a surface that teracell knows.`);
  const grids = local_grids();
  let last: string | null = null;
  // Those of a server keep their ids.
  const served = is_alone() ? [] : await list_grids().then((list) => [...list.grids, ...list.unreadable], () => []);
  const taken = new Set(served.map(({ id }) => id));
  for (const file of perhaps) {
    const added = await grids.add(() => ({ kind: "file", file, name: file.name }), file.name, null, taken);
    if ("wrong" in added) {
      say(`${file.name} can't be read`, { detail: added.wrong });
      continue;
    }
    last = added.id;
    const stem = stem_of(file.name);
    if (last.startsWith(`${stem}-`)) say(`${file.name} is “${last}” here: there is another “${stem}”.`);
  }
  ask_again();
  if (last !== null) location.hash = `#g=${encodeURIComponent(last)}`;
}

// Whether files are held over the page.
export const dragged = signal(false);

// What is dropped anywhere on the page is opened.
export function watch_drops(): void {
  const has_files = (event: DragEvent) => event.dataTransfer?.types.includes("Files") ?? false;
  document.addEventListener("dragover", (event) => {
    if (!has_files(event)) return;
    event.preventDefault();
    dragged.value = true;
  });
  document.addEventListener("dragleave", (event) => event.relatedTarget === null && (dragged.value = false));
  document.addEventListener("drop", (event) => {
    if (!has_files(event)) return;
    event.preventDefault();
    dragged.value = false;
    void open_files([...event.dataTransfer!.files]);
  });
}
