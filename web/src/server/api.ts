// The one way to ask the server for something, what can go wrong, and the token that it may demand.
import { signal } from "@preact/signals";
import type { Findings } from "../base/findings";
import { prose } from "../base/format";
import { type GridInfo, type GridSummary, type UnreadableFile, ids_in } from "../base/grid";
import { drop, say } from "../base/messages";
import { if_allowed } from "../base/storage";
import { ask_again, doubt, not_reached, reached } from "./connection";
import { answerer, ask, is_alone } from "./transport";

// The server answered with an error, or it did not answer at all (status 0).
export class ServerError extends Error {
  constructor(
    readonly status: number,
    readonly code: string,
    message: string,
  ) {
    super(message);
  }
}

async function error_of(response: Response): Promise<ServerError> {
  try {
    const { error } = (await response.json()) as { error: { code: string; message: string } };
    return new ServerError(response.status, error.code, error.message);
  } catch {
    return new ServerError(response.status, "http", `the server answered ${response.status} ${response.statusText}`);
  }
}

// The server's address with its base path, without a '/' at its end.
export const server_root = (): string => new URL(".", location.href).href.slice(0, -1);

// A server may demand a token (--token-file). It gives out the page without one, because browsers send none when they
// open an address. The page then asks for the token: the form is shown while `token_wanted`, and it passes what was
// typed to give_token(). The token is kept for this tab alone; where storage is forbidden, as in frames of other sites,
// only until the page is left.
export const token_wanted = signal(false);
const token_key = () => `teracell-token ${new URL(".", location.href).pathname}`; // another server may be reached under another path

let token = if_allowed(() => sessionStorage.getItem(token_key()));
export const has_token = (): boolean => token !== null;

// Why a text cannot be a token; null when it can. A field of an HTTP header takes visible ASCII characters only.
export function fault_of_token(text: string): string | null {
  const odd = [...text].find((c) => c < "!" || c > "~");
  if (odd === undefined) return null;
  const code = odd.codePointAt(0)!.toString(16).toUpperCase().padStart(4, "0");
  return `A token consists of visible ASCII characters. This one contains U+${code}.`;
}

// Everything that was refused is asked for again.
export function give_token(text: string): void {
  token = text;
  if_allowed(() => sessionStorage.setItem(token_key(), text));
  token_wanted.value = false;
  ask_again();
}

// Counts how often an address had no answer any more because the file that it names was replaced.
export const version_gone = signal(0);

// Whether an error means that. A banner then says so for the whole page (banners.tsx).
export const is_version_gone = (error: unknown, path: string): boolean => error instanceof ServerError && error.status === 404 && path.includes("v=");

export const is_damage = (error: unknown): boolean => error instanceof ServerError && error.code === "damaged";

// A proxy answers so in place of a server that is gone. A banner says that.
const is_proxys = (status: number) => status === 502 || status === 504;

export const damaged_grids = signal<readonly string[]>([]); // the ids of those of which something could not be read
const damage_text = (id: string) => `“${id}” is damaged: parts of it can't be read`;
function say_damaged(path: string, message: string): void {
  const ids = ids_in(path);
  note_damage(ids.find((one) => message.startsWith(`${one}.`)) ?? ids[0]!, message); // of two that are compared, the message names the file
}
export function note_damage(id: string, message: string): void {
  if (damaged_grids.peek().includes(id)) return;
  damaged_grids.value = [...damaged_grids.peek(), id];
  say(damage_text(id), { detail: message });
}
const no_answer = () => (is_alone() ? "The page could not answer" : "The server could not answer");
// A banner says what these messages said.
export function drop_complaints(): void {
  for (const id of damaged_grids.peek()) drop(damage_text(id));
  damaged_grids.value = [];
  drop(no_answer());
}

// Tells the whole page about an error that concerns it, whichever part of the page asked.
function noted(error: ServerError, path: string): ServerError {
  if (error.status === 401) token_wanted.value = true;
  else if (is_version_gone(error, path)) ++version_gone.value;
  else if (is_damage(error)) say_damaged(path, error.message);
  else if (error.status >= 500 && !is_proxys(error.status)) say(no_answer(), { detail: error.message });
  return error;
}

const SLOW = 10_000; // milliseconds without an answer, after which the server's health is checked

// Fetches an address below the server's root. Throws ServerError, or AbortError when the signal ends it.
export async function get(path: string, options: { signal?: AbortSignal; priority?: "high" | "low" | "auto" } = {}): Promise<Response> {
  const headers: HeadersInit = token === null ? {} : { authorization: `Bearer ${token}` };
  const timer = setTimeout(() => void doubt(), SLOW);
  let response: Response;
  try {
    response = await ask(path, { ...options, headers });
  } catch (error) {
    if (options.signal?.aborted) throw error;
    not_reached();
    throw new ServerError(0, "unreachable", `${answerer()} can't be reached`);
  } finally {
    clearTimeout(timer);
  }
  if (is_proxys(response.status)) not_reached();
  else reached();
  if (!response.ok) {
    const error = await error_of(response);
    options.signal?.throwIfAborted(); // while its reason came
    throw noted(error, path);
  }
  return response;
}

const BUSY_FIRST = 1000;
const BUSY_LONGEST = 15_000;

// A request that a busy server refuses (503) is repeated after ever longer waits, until the signal ends it. One that takes too
// much work is not: it would take as much again.
export async function get_patiently(path: string, signal: AbortSignal): Promise<Response> {
  for (let wait = BUSY_FIRST; ; wait = Math.min(2 * wait, BUSY_LONGEST)) {
    try {
      return await get(path, { signal });
    } catch (error) {
      if (!(error instanceof ServerError && error.status === 503) || error.code === "too_dear") throw error;
    }
    await new Promise((done) => setTimeout(done, wait));
    signal.throwIfAborted();
  }
}

// With a signal, it has patience.
export const get_json = async <T>(path: string, signal?: AbortSignal): Promise<T> =>
  (await (signal ? get_patiently(path, signal) : get(path))).json() as Promise<T>;

type Listing = { grids: GridSummary[]; unreadable: UnreadableFile[] };
let listing: Promise<Listing> | null = null;
// What is asked for first is on its way while the rest of the page still is.
export function ask_ahead(): void {
  listing = list_grids();
  listing.catch(() => {}); // whoever asks for it will hear
}
export function list_grids(signal?: AbortSignal): Promise<Listing> {
  const asked = listing;
  listing = null;
  return asked ?? get_json<Listing>("api/v1/grids", signal);
}
export const grid_info = (id: string, signal?: AbortSignal) => get_json<GridInfo>(`api/v1/grids/${encodeURIComponent(id)}`, signal);

// What `teracell check` has found; null when nobody has looked through the cells of the grid.
export async function grid_findings(id: string, signal: AbortSignal): Promise<Findings | null> {
  const { grids } = await list_grids(signal);
  return grids.find((grid) => grid.id === id)?.checked ? checked_findings(id, signal) : null;
}
// The same for a grid that is known to be checked.
export async function checked_findings(id: string, signal: AbortSignal): Promise<Findings> {
  const found = await get_json<Findings>(`api/v1/grids/${encodeURIComponent(id)}/check`, signal);
  return { ...found, findings: found.findings.map((finding) => ({ ...finding, text: prose(finding.text) })) };
}
