// The tiles that the page holds, and the requests for those that it wants. Before each frame the views say what they
// want, most urgent first. The store
// - keeps a few requests going,
// - gives up requests that nobody wants any more when it needs their place,
// - keeps tiles within a number of bytes, and drops the least recently used ones first,
// - tries requests that failed again after a while. Nothing polls.
//
// Browsers send at most six requests at a time to one server over HTTP/1.1. Requests for tiles ahead of time leave two
// of them to the rest of the page. A request that nobody wants goes on while there is room: closing its connection
// would cost a new one, and the tile may be wanted again.
import { batch } from "@preact/signals";
import type { Index3 } from "../base/grid";
import { ServerError, is_damage } from "../server/api";
import type { TileCounters } from "./counters";
import { type Place, place_name, tile_size } from "./place";

// What a store holds: labels (tile.ts) or leaves (leaf_tile.ts).
export interface Held {
  readonly place: Place;
  readonly name: string;
  readonly bytes: number; // that it takes in memory
  readonly damaged?: boolean; // it is what could be read of a damaged one
  readonly unreadable?: number | null; // null: all of it could be read
}

export interface Source<T extends Held> {
  address(place: Place): string;
  what_is_left?(place: Place): string; // the address of a tile that is damaged, with what can be read of it
  decode(place: Place, size: readonly [number, number], buffer: ArrayBuffer): T; // throws Error for bytes that are no such tile
}

export interface Want {
  readonly place: Place;
  readonly ahead: boolean; // not in sight yet
}

export type Fetch = (path: string, options: { signal: AbortSignal; priority: "high" | "low" }) => Promise<{ arrayBuffer(): Promise<ArrayBuffer> }>;

interface Flight {
  readonly abort: AbortController;
  readonly ahead: boolean;
}

interface Failure {
  readonly count: number;
  readonly until: number; // milliseconds, as performance.now()
  readonly damaged: boolean;
}

export const LIMITS = { bytes: 96 * 2 ** 20, requests: 6, ahead: 4, retry_ms: 1000, retry_most_ms: 30_000, latencies: 64 };

export class TileStore<T extends Held> {
  // Called when a tile came or failed.
  on_change: () => void = () => {};
  // Called when the server refuses what the source asks for: such a tile is not asked for again, nor missed.
  on_refused: (error: ServerError) => void = () => {};
  private readonly tiles = new Map<string, T>(); // least recently used first
  private readonly flights = new Map<string, Flight>();
  private readonly failures = new Map<string, Failure>();
  private wants: readonly Want[] = [];
  private bytes = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private closed = false;

  constructor(
    private readonly source: Source<T>,
    private readonly cells: Index3,
    private readonly counters: TileCounters,
    private readonly fetch_tile: Fetch,
    private readonly limits: typeof LIMITS = LIMITS,
  ) {}

  find(place: Place): T | null {
    const name = place_name(place);
    const tile = this.tiles.get(name);
    if (!tile) return null;
    this.tiles.delete(name);
    this.tiles.set(name, tile);
    return tile;
  }

  is_damaged(place: Place): boolean {
    return this.failures.get(place_name(place))?.damaged ?? false;
  }

  // Replaces what was wanted before. The most urgent tiles come first.
  want(wants: readonly Want[]): void {
    this.wants = wants;
    this.pump();
  }

  // The server is back: asks at once for the tiles that failed or are damaged, and again for those on their way, which may never come.
  retry(): void {
    this.drop(({ damaged }) => damaged === true);
  }

  // The source answers otherwise from now on: asks anew for the tiles that this changes.
  renew(changed: (place: Place) => boolean): void {
    this.drop(({ place }) => changed(place));
  }

  private drop(is_old: (tile: T) => boolean): void {
    this.abandon();
    this.failures.clear();
    for (const [name, tile] of this.tiles) {
      if (!is_old(tile)) continue;
      this.tiles.delete(name);
      this.bytes -= tile.bytes;
    }
    this.pump();
    this.on_change();
  }

  close(): void {
    this.closed = true;
    clearTimeout(this.timer);
    this.abandon();
    this.tiles.clear();
  }

  private abandon(): void {
    for (const { abort } of this.flights.values()) abort.abort();
    this.flights.clear();
  }

  private pump(): void {
    if (this.closed) return;
    clearTimeout(this.timer);
    const now = performance.now();
    const open = this.wants.filter(({ place }) => !this.tiles.has(place_name(place)));
    const urgent = new Set(open.filter((want) => !want.ahead).map(({ place }) => place_name(place)));
    const wanted = new Set(open.map(({ place }) => place_name(place)));
    let wait = Number.POSITIVE_INFINITY;
    let waiting = 0;
    for (const { place, ahead } of open) {
      const name = place_name(place);
      if (this.flights.has(name)) continue;
      const failure = this.failures.get(name);
      if (failure && failure.until > now) {
        wait = Math.min(wait, failure.until - now);
        continue;
      }
      if (this.make_room(ahead, urgent, wanted)) void this.fetch_one(place, name, { abort: new AbortController(), ahead });
      else ++waiting;
    }
    if (wait < Number.POSITIVE_INFINITY) this.timer = setTimeout(() => this.pump(), wait + 1);
    this.count(waiting);
  }

  private make_room(ahead: boolean, urgent: ReadonlySet<string>, wanted: ReadonlySet<string>): boolean {
    if (this.flights.size < (ahead ? this.limits.ahead : this.limits.requests)) return true;
    let victim: string | null = null;
    for (const name of this.flights.keys()) {
      if (!wanted.has(name)) {
        victim = name;
        break;
      }
      if (!ahead && !urgent.has(name)) victim ??= name;
    }
    if (victim === null) return false;
    this.flights.get(victim)!.abort.abort();
    this.flights.delete(victim);
    return this.flights.size < (ahead ? this.limits.ahead : this.limits.requests);
  }

  private async fetch_one(place: Place, name: string, flight: Flight): Promise<void> {
    this.flights.set(name, flight);
    const began = performance.now();
    try {
      let is_rest = false;
      const load = async (address: string) => {
        const response = await this.fetch_tile(address, { signal: flight.abort.signal, priority: flight.ahead ? "low" : "high" });
        return response.arrayBuffer();
      };
      const buffer = await load(this.source.address(place)).catch((error: unknown) => {
        const rest = is_damage(error) ? this.source.what_is_left?.(place) : undefined;
        if (rest === undefined) throw error;
        is_rest = true;
        return load(rest);
      });
      if (this.closed || flight.abort.signal.aborted) return;
      const tile = this.source.decode(place, tile_size(place, this.cells), buffer);
      const damaged = is_rest && tile.unreadable !== null; // else what can't be read is elsewhere in its chunks
      this.keep(damaged ? { ...tile, damaged } : tile);
      this.failures.delete(name);
      if (damaged) this.failures.set(name, { count: 1, until: performance.now() + this.limits.retry_most_ms, damaged });
      this.counters.latencies.value = [...this.counters.latencies.value.slice(1 - this.limits.latencies), performance.now() - began];
    } catch (error) {
      if (this.closed || flight.abort.signal.aborted) return;
      this.fail(name, error);
    } finally {
      if (this.flights.get(name) === flight) this.flights.delete(name);
    }
    this.pump();
    this.on_change();
  }

  private keep(tile: T): void {
    this.bytes += tile.bytes - (this.tiles.get(tile.name)?.bytes ?? 0);
    this.tiles.delete(tile.name);
    this.tiles.set(tile.name, tile);
    for (const [name, old] of this.tiles) {
      if (this.bytes <= this.limits.bytes || name === tile.name) break;
      this.tiles.delete(name);
      this.bytes -= old.bytes;
    }
  }

  private fail(name: string, error: unknown): void {
    const count = (this.failures.get(name)?.count ?? 0) + 1;
    // Bytes that do not form a tile mean damage, just like an answer that says so. A connection that ends too early
    // (TypeError) does not.
    const refused = error instanceof ServerError && error.status === 400;
    const damaged = refused || (error instanceof ServerError ? error.status === 500 : !(error instanceof TypeError));
    if (refused) this.on_refused(error);
    const wait = refused ? Number.POSITIVE_INFINITY : damaged ? this.limits.retry_most_ms : Math.min(this.limits.retry_ms * 2 ** (count - 1), this.limits.retry_most_ms);
    this.failures.set(name, { count, until: performance.now() + wait, damaged });
  }

  private count(waiting: number): void {
    const c = this.counters;
    const damaged = [...this.failures.values()].filter((failure) => failure.damaged).length;
    batch(() => {
      c.in_flight.value = this.flights.size;
      c.waiting.value = waiting;
      c.bytes.value = this.bytes;
      c.tiles.value = this.tiles.size;
      c.failed.value = this.failures.size - damaged;
      c.damaged.value = damaged;
    });
  }
}
