import { signal } from "@preact/signals";

// What the tiles of the views cost: for the status panel. Times are of requests that reached the network or the browser's cache.
export class TileCounters {
  readonly in_flight = signal(0);
  readonly waiting = signal(0);
  readonly bytes = signal(0); // held decoded
  readonly tiles = signal(0); // held decoded
  readonly latencies = signal<readonly number[]>([]); // milliseconds, the last 64, oldest first
  readonly failed = signal(0); // that are tried again after a while
  readonly damaged = signal(0); // that the server can't read: drawn hatched
}
