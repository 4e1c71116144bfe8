// Grids without a server: files that a host gives out by ranges, that the user gives to the page, or that are in it. The module answers about
// them, in two workers: one for what is quick, and one for what may take long, so that slices stay swift while 3D gets sharp. The second one
// begins when it is needed: until then the machine is for the first picture.
import { type GridSummary, type UnreadableFile, ids_in } from "../base/grid";
import { words_of } from "../base/messages";
import { stem_of } from "../base/names";
import { type Ask, is_alone, note_read_here } from "../server/transport";
import { make_worker, module_code } from "./beside";
import type { Answer } from "./instance";
import { type Place, type Source, SourceError, source_at } from "./sources";
import type { FromWorker, ToWorker } from "./worker";

const SLOW = /^api\/v1\/grids\/[^/]+\/(view\.|stats|diff|changed|line|column|box\.|slice)/;
const CHECK = /^api\/v1\/grids\/[^/]+\/check$/;
const FILE = /^api\/v1\/grids\/[^/]+\/file\.tcell$/;

interface Waiting {
  resolve(message: FromWorker): void;
  reject(error: unknown): void;
}

class Helper {
  private readonly worker = make_worker();
  private readonly waiting = new Map<number, Waiting>();
  private next = 0;
  private broken: Error | null = null; // why the worker does not answer
  // `held`: grids that are in the page, by their numbers.
  constructor(private readonly held: ReadonlyMap<number, Source>) {
    this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => this.take(data);
    this.worker.onerror = ({ message }) => this.fail(`a part of this page, its worker, can't be started: ${message || "its file may be missing on the host of the page"}`);
    this.worker.onmessageerror = () => this.fail("the browser gives the worker nothing to read");
    try {
      this.tell({ kind: "module", code: module_code() });
    } catch (error) {
      this.fail(words_of(error));
    }
  }

  // The id of the grid that is there. Throws SourceError, or Error if it is none.
  async open(place: Place, as: string): Promise<{ id: string; place: Place }> {
    const opened = (await this.send({ kind: "open", place, as })) as FromWorker & { kind: "opened" };
    if (opened.wrong) throw new Error(opened.text);
    return { id: opened.text, place: opened.place };
  }
  async answer(target: string, signal?: AbortSignal | null): Promise<Answer> {
    return ((await this.send({ kind: "ask", target }, signal)) as FromWorker & { kind: "answer" }).answer;
  }

  // What the worker says to a message, which gets an id. Throws SourceError.
  private send(message: { kind: "ask"; target: string } | { kind: "open"; place: Place; as: string }, signal?: AbortSignal | null): Promise<FromWorker> {
    signal?.throwIfAborted();
    const id = this.next++;
    return new Promise((resolve, reject) => {
      if (this.broken) return reject(this.broken);
      this.waiting.set(id, { resolve, reject });
      signal?.addEventListener("abort", () => this.give_up(id, signal.reason));
      this.tell({ ...message, id });
    });
  }

  private take(message: FromWorker): void {
    if (message.kind === "wanted") return void this.read(message);
    const { resolve, reject } = this.waiting.get(message.id) ?? {};
    this.waiting.delete(message.id);
    if (message.kind !== "failed") return resolve?.(message);
    if (!message.code) return reject?.(new Error(message.message));
    const error = new SourceError(message.code, message.message);
    error.grid = message.grid;
    reject?.(error);
  }
  private async read({ id, grid, offset, size }: FromWorker & { kind: "wanted" }): Promise<void> {
    try {
      const bytes = await this.held.get(grid)!.read(offset, size);
      this.tell({ kind: "bytes", id, bytes }, [bytes.buffer]);
    } catch (error) {
      this.tell({ kind: "bytes", id, bytes: words_of(error) });
    }
  }
  private fail(message: string): void {
    this.broken = new Error(message);
    for (const id of [...this.waiting.keys()]) this.give_up(id, this.broken);
  }
  private give_up(id: number, error: unknown): void {
    const waiting = this.waiting.get(id);
    if (!waiting) return;
    this.waiting.delete(id);
    this.tell({ kind: "forget", id });
    waiting.reject(error);
  }
  private tell(message: ToWorker, transfer: Transferable[] = []): void {
    this.worker.postMessage(message, transfer);
  }
}

const json = (status: number, value: unknown) => new Response(JSON.stringify(value), { status, headers: { "content-type": "application/json" } });
const failure = (status: number, code: string, message: string) => json(status, { error: { code, message } });

const response_of = ({ status, type, etag, body }: Answer) => new Response(body, { status, headers: { "content-type": type, etag } });

// What `teracell check` has found in a grid with this hash.
export interface Checked {
  readonly hash: string;
  text(): Promise<string>;
}

interface LocalGrid {
  readonly place: Place;
  readonly order: number;
  readonly checked: Checked | null;
  changed: string | null; // what was said when its file was found to be another one
  in_slow: Promise<unknown> | null; // that it is opened in the second worker
}

export type Added = { readonly id: string } | { readonly wrong: string };

export class LocalGrids {
  private readonly grids = new Map<string, LocalGrid>(); // by id
  private readonly unreadable: UnreadableFile[] = [];
  private readonly quick: Helper;
  private slow: Helper | null = null;
  private readonly names = new Set<string>();
  private readonly adds = new Set<Promise<unknown>>(); // under way
  private lost: LocalGrid | null = null; // whose host could not be reached

  // `held`: grids that are in the page, by their numbers.
  constructor(private readonly held: ReadonlyMap<number, Source>) {
    this.quick = new Helper(held);
  }

  // Adds a grid. If it can't be read, the list of grids says why. `taken`: ids that others have.
  add(place: () => Place, name: string, checked: Checked | null = null, taken: ReadonlySet<string> = new Set()): Promise<Added> {
    const added = this.add_now(place, name, checked, taken);
    this.adds.add(added);
    return added.finally(() => this.adds.delete(added));
  }

  private async add_now(asked: () => Place, name: string, checked: Checked | null, taken: ReadonlySet<string>): Promise<Added> {
    const stem = stem_of(name);
    let id = stem;
    for (let n = 2; this.names.has(id) || taken.has(id); ++n) id = `${stem}-${n}`;
    this.names.add(id);
    const as = `${id}.tcell`;
    const order = this.names.size;
    try {
      const { id, place } = await this.quick.open(asked(), as);
      this.grids.set(id, { place, order, checked, changed: null, in_slow: null });
      note_read_here(id, place.kind !== "file");
      return { id };
    } catch (error) {
      const wrong = words_of(error).replace(`${as}: `, `${name}: `); // its own name is known to whoever has the file
      this.unreadable.push({ id: stem, error: wrong });
      return { wrong };
    }
  }

  private source_of({ place }: LocalGrid): Promise<Source> {
    return source_at(place, ({ grid }) => this.held.get(grid)!);
  }

  // The worker for what may take long, with the grids that an address names.
  private async slow_helper(path: string): Promise<Helper> {
    const helper = (this.slow ??= new Helper(this.held));
    for (const id of ids_in(path)) {
      const grid = this.grids.get(id);
      if (!grid) continue;
      try {
        await (grid.in_slow ??= helper.open(grid.place, `${id}.tcell`));
      } catch (error) {
        grid.in_slow = null;
        if (error instanceof SourceError) error.grid = id;
        throw error;
      }
    }
    return helper;
  }

  // Answers for its grids; `before` answers for those of a server, if there is one.
  async answer(path: string, options: Parameters<Ask>[1], before: Ask): Promise<Response> {
    if (path === "api/v1/grids") return this.lists(is_alone() ? null : before(path, options));
    if (path === "healthz" && is_alone()) return this.health();
    const [id] = ids_in(path);
    // One that is there is asked at once, and not after the frame that is being drawn.
    while (is_alone() && id !== undefined && !this.grids.has(id) && this.adds.size > 0) await Promise.race(this.adds);
    const grid = id === undefined ? undefined : this.grids.get(id);
    if (!grid && !is_alone()) return before(path, options);
    options.signal?.throwIfAborted();
    try {
      if (grid?.checked && CHECK.test(path)) return new Response(await grid.checked.text(), { headers: { "content-type": "application/json" } });
      if (grid && FILE.test(path)) return await whole_file(await this.source_of(grid));
      const helper = SLOW.test(path) ? await this.slow_helper(path) : this.quick;
      return response_of(await helper.answer(`/${path}`, options.signal));
    } catch (error) {
      options.signal?.throwIfAborted();
      if (!(error instanceof SourceError)) return failure(500, "failed", words_of(error));
      const whose = error.grid === null ? grid : this.grids.get(error.grid);
      if (whose && error.code === "unreachable") this.lost = whose;
      if (error.code === "unreachable") throw new TypeError(error.message);
      if (whose && error.code === "replaced") whose.changed = error.message;
      // As a server answers for a version that is gone.
      return failure(error.code === "replaced" ? 404 : 500, error.code, error.message);
    }
  }

  private async list(): Promise<GridSummary[]> {
    const { body } = await this.quick.answer("/api/v1/grids");
    return (JSON.parse(new TextDecoder().decode(body)) as { grids: GridSummary[] }).grids;
  }

  // A grid of an address that was replaced has another version now, which a new page will read. A file that was changed must be given again.
  private async lists(served: Promise<Response> | null): Promise<Response> {
    const others = served ? ((await (await served).json()) as { grids: GridSummary[]; unreadable: UnreadableFile[] }) : { grids: [], unreadable: [] };
    await Promise.all(this.adds);
    const [grids, unreadable] = [[...others.grids], [...others.unreadable, ...this.unreadable]];
    const own = this.grids.size > 0 ? await this.list() : [];
    for (const grid of own.sort((a, b) => this.grids.get(a.id)!.order - this.grids.get(b.id)!.order)) {
      const { changed, place, checked } = this.grids.get(grid.id)!;
      if (changed === null) grids.push({ ...grid, checked: checked?.hash === grid.hash });
      else if (place.kind === "address") grids.push({ ...grid, hash: "" });
      else unreadable.push({ id: grid.id, error: changed });
    }
    return json(200, { ...others, grids, unreadable });
  }

  private async health(): Promise<Response> {
    try {
      if (this.lost) await (await this.source_of(this.lost)).read(0, 1);
    } catch (error) {
      if (!(error instanceof SourceError) || error.code === "unreachable") throw error;
      if (error.code === "replaced") this.lost!.changed = error.message; // the host is back, with another file
    }
    this.lost = null;
    return new Response("ok");
  }
}

const WHOLE = 1 << 20; // bytes that are read at once

async function whole_file(source: Source): Promise<Response> {
  const parts: Uint8Array<ArrayBuffer>[] = [];
  for (let at = 0; at < source.size; at += WHOLE) parts.push(await source.read(at, Math.min(WHOLE, source.size - at)));
  return new Response(new Blob(parts), { headers: { "content-type": "application/octet-stream" } });
}
