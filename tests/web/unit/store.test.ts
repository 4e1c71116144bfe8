// The tile store with a server that answers when the test says so.
import assert from "node:assert/strict";
import test from "node:test";
import { GridAddress } from "@page/base/grid";
import { toasts } from "@page/base/messages";
import { ServerError, get } from "@page/server/api";
import type { Place } from "@page/tiles/place";
import { SetTable } from "@page/tiles/sets";
import { type Tile, decode_tile, set_at } from "@page/tiles/tile";
import { LIMITS, TileStore } from "@page/tiles/store";
import { TileCounters } from "@page/tiles/counters";

const place = (column: number): Place => ({ axis: 2, index: 3, level: 0, column, row: 0 });
const soon = () => new Promise((done) => setTimeout(done, 0));

// Tiles of 512 x 512 cells and two sets. They are kept as they come: 262,144 bytes and a little more.
const body = () => new Uint8Array([2, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, ...new Uint8Array(512 * 512)]).buffer;

const address = new GridAddress("g", "hash");
const sets = new SetTable();
const labels = {
  address: (p: Place) => address.tile(p.axis, p.index, p.level, p.column, p.row),
  decode: (at: Place, size: readonly [number, number], buffer: ArrayBuffer) => decode_tile(at, size, buffer, sets),
};

class Server {
  readonly open = new Map<string, { answer: (error?: unknown) => Promise<unknown>; signal: AbortSignal }>();
  readonly asked: string[] = [];
  readonly store: TileStore<Tile>;
  readonly counters = new TileCounters();
  constructor(limits: Partial<typeof LIMITS> = {}) {
    const fetch = (path: string, { signal }: { signal: AbortSignal }) =>
      new Promise<{ arrayBuffer(): Promise<ArrayBuffer> }>((resolve, reject) => {
        const name = /(\d+)_0\.bin/.exec(path)![1]!;
        this.asked.push(name);
        this.open.set(name, {
          signal,
          answer: (error) => {
            this.open.delete(name);
            if (error) reject(error);
            else resolve({ arrayBuffer: async () => body() });
            return soon();
          },
        });
        signal.addEventListener("abort", () => {
          this.open.delete(name);
          reject(new DOMException("given up", "AbortError"));
        });
      });
    this.store = new TileStore(labels, [100_000, 512, 10], this.counters, fetch, { ...LIMITS, ...limits });
  }
  want(columns: readonly number[], ahead: readonly number[] = []): void {
    this.store.want([...columns.map((c) => ({ place: place(c), ahead: false })), ...ahead.map((c) => ({ place: place(c), ahead: true }))]);
  }
  has = (column: number) => this.store.find(place(column)) !== null;
  names = () => [...this.open.keys()].map(Number);
}

test("the most urgent tiles come first, with no more requests than browsers open connections", async () => {
  const s = new Server();
  s.want([4, 3, 2, 1, 0, 5, 6, 7]);
  assert.deepEqual(s.names(), [4, 3, 2, 1, 0, 5]);
  await s.open.get("2")!.answer();
  assert.ok(s.has(2));
  assert.deepEqual(s.names(), [4, 3, 1, 0, 5, 6]);
  assert.equal(s.counters.in_flight.value, 6);
  s.store.close();
});

test("requests ahead of time leave room for others, and give way to them", async () => {
  const s = new Server();
  s.want([], [1, 2, 3, 4, 5, 6]);
  assert.equal(s.names().length, LIMITS.ahead);
  s.want([11, 12, 13, 14, 15, 16], [1, 2, 3]);
  assert.deepEqual(s.names().sort(), [11, 12, 13, 14, 15, 16]);
  s.store.close();
});

test("a request that nobody wants any more is given up as soon as its place is needed", async () => {
  const s = new Server();
  s.want([1, 2, 3, 4, 5, 6]);
  const given_up = s.open.get("1")!.signal;
  s.want([7, 2]);
  assert.ok(s.names().includes(7) && s.names().includes(2));
  assert.equal(s.names().length, 6);
  s.want([7, 2, 8, 9, 10, 11]);
  assert.deepEqual(s.names().sort((a, b) => a - b), [2, 7, 8, 9, 10, 11]);
  assert.ok(given_up.aborted);
  s.store.close();
});

test("no tile is asked for twice", async () => {
  const s = new Server();
  s.want([1, 2]);
  s.want([1, 2]);
  await s.open.get("1")!.answer();
  await s.open.get("2")!.answer();
  s.want([1, 2]);
  assert.deepEqual(s.asked, ["1", "2"]);
  s.store.close();
});

test("the store holds a number of bytes, and the least recently used tile goes first", async () => {
  const s = new Server({ bytes: 4 * 263_000 });
  for (const c of [1, 2, 3, 4]) {
    s.want([c]);
    await s.open.get(String(c))!.answer();
  }
  assert.ok(s.has(1)); // this uses tile 1, so 2 is the oldest now
  s.want([5]);
  await s.open.get("5")!.answer();
  assert.deepEqual([1, 2, 3, 4, 5].filter(s.has), [1, 3, 4, 5]);
  assert.ok(s.counters.bytes.value <= 4 * 263_000);
  s.store.close();
});

test("a tile that failed is tried again after a while, or when the server is back; a damaged tile is reported", async () => {
  const s = new Server({ retry_ms: 20, retry_most_ms: 1_000_000 });
  s.want([1, 2]);
  await s.open.get("1")!.answer(new TypeError("the connection ended within the answer"));
  await s.open.get("2")!.answer(new ServerError(500, "damaged", "a chunk is damaged"));
  assert.deepEqual([s.store.is_damaged(place(1)), s.store.is_damaged(place(2))], [false, true]);
  assert.deepEqual([s.counters.failed.value, s.counters.damaged.value], [1, 1]);
  while (!s.open.has("1")) await new Promise((done) => setTimeout(done, 10));
  assert.deepEqual(s.names(), [1]); // the damaged one is not tried so soon
  await s.open.get("1")!.answer(new ServerError(0, "unreachable", "the server can't be reached"));
  s.store.retry();
  assert.deepEqual(s.names(), [1, 2]);
  await s.open.get("2")!.answer();
  assert.ok(s.has(2) && !s.store.is_damaged(place(2)));
  s.store.close();
});

test("of a damaged tile what can be read of it is asked for at once, and kept", async () => {
  const asked: string[] = [];
  const counters = new TileCounters();
  const fetch = async (path: string) => {
    asked.push(path);
    if (!path.includes("damage=1")) throw new ServerError(500, "damaged", "level 0 chunk (0, 0, 0)");
    return { arrayBuffer: async () => new Uint8Array([2, 0, 0, 0, 0, 0, 1, 0, 7, 0, ...new Uint8Array(512 * 512 - 1).fill(1), 0]).buffer };
  };
  const left = { ...labels, what_is_left: (p: Place) => address.damaged_tile(p.axis, p.index, p.level, p.column, p.row) };
  const store = new TileStore(left, [100_000, 512, 10], counters, fetch);
  store.want([{ place: place(3), ahead: false }]);
  await soon();
  await soon();
  const tile = store.find(place(3))!;
  assert.equal(asked.length, 2);
  assert.deepEqual([tile.damaged, sets.members(tile.unreadable!), set_at(tile, 3 * 512 + 511, 511) === tile.unreadable], [true, [], true]);
  assert.deepEqual(sets.members(set_at(tile, 3 * 512, 0)), [7]);
  assert.deepEqual([counters.damaged.value, counters.failed.value], [1, 0]);
  store.want([{ place: place(3), ahead: false }]);
  assert.equal(asked.length, 2, "it is not tried so soon");
  store.retry();
  await soon();
  await soon();
  assert.equal(asked.length, 4);
  assert.ok(store.find(place(3))!.damaged);
});

test("of a request that is called off while its error comes, nobody is told", async () => {
  const abort = new AbortController();
  const json = async () => {
    abort.abort();
    throw abort.signal.reason;
  };
  (globalThis as { fetch: unknown }).fetch = async () => ({ ok: false, status: 500, json });
  await assert.rejects(get("api/v1/grids/g/stats", { signal: abort.signal }), { name: "AbortError" });
  assert.deepEqual(toasts.value, []);
});
