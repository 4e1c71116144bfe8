import { signal } from "@preact/signals";

// What the tiles of the views cost, for the status panel. Times are those of requests that the network or the browser's
// cache answered.
export class TileCounters {
  readonly in_flight = signal(0);
  readonly waiting = signal(0);
  readonly bytes = signal(0); // of decoded tiles that are held
  readonly tiles = signal(0); // decoded tiles that are held
  readonly latencies = signal<readonly number[]>([]); // milliseconds, the last 64, oldest first
  readonly failed = signal(0); // tiles that failed and are tried again after a while
  readonly damaged = signal(0); // tiles that the server can't read: they are drawn hatched
}
