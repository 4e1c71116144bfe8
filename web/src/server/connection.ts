// Whether the server can be reached. Every request reports how it went (api.ts). When one cannot reach the server, the
// page asks for its health at growing intervals until it answers. Then `returned` counts up, and everything that waits
// for data asks again.
import { signal } from "@preact/signals";
import { ask } from "./transport";

// `since`: milliseconds, as Date.now().
export const connection = signal<{ state: "there" | "lost"; since: number }>({ state: "there", since: Date.now() });
export const returned = signal(0);
export const next_try = signal<number | null>(null); // when the server's health is asked for again, as Date.now()

const FIRST_WAIT = 1000;
const LONGEST_WAIT = 15000;
let timer = 0;
let wait = FIRST_WAIT;

export function reached(): void {
  if (connection.value.state === "there") return;
  clearTimeout(timer);
  next_try.value = null;
  connection.value = { state: "there", since: Date.now() };
  ask_again();
}

export function not_reached(): void {
  if (connection.value.state === "lost") return;
  connection.value = { state: "lost", since: Date.now() };
  wait = FIRST_WAIT;
  schedule();
}

function schedule(): void {
  next_try.value = Date.now() + wait;
  timer = window.setTimeout(try_now, wait);
  wait = Math.min(2 * wait, LONGEST_WAIT);
}

// A proxy may answer in place of a server that is gone, so only an answer of success counts.
async function is_healthy(): Promise<boolean> {
  try {
    return (await ask("healthz", { cache: "no-store", signal: AbortSignal.timeout(10000) })).ok;
  } catch {
    return false;
  }
}

export async function try_now(): Promise<void> {
  clearTimeout(timer);
  next_try.value = null;
  if (await is_healthy()) return reached();
  if (connection.value.state === "lost") schedule();
}

// An answer takes very long. It may be large, or the server may be gone without having said so.
export async function doubt(): Promise<void> {
  if (connection.value.state === "there" && !(await is_healthy())) not_reached();
}

// Everything that waits for data asks again.
export const ask_again = () => void ++returned.value;

export function until_returned(): Promise<void> {
  const before = returned.peek();
  return new Promise((resolve) => {
    const stop = returned.subscribe((count) => {
      if (count === before) return;
      stop();
      resolve();
    });
  });
}

// The browser knows that the network is gone before any request fails.
export function watch_network(): void {
  addEventListener("offline", not_reached);
  addEventListener("online", () => connection.value.state === "lost" && void try_now());
}
