// Grids without a server: files that a host gives out by ranges, or that the user gives to the page. The module answers about them, in two
// workers: one for what is quick, and one for what may take long, so that slices stay swift while 3D gets sharp.
import module_address from "virtual:module";
import type { GridSummary, UnreadableFile } from "../base/grid";
import { type Ask, answer_by } from "../server/transport";
import type { Answer, Missing } from "./instance";
import { KeptBytes } from "./kept_bytes";
import { type Source, SourceError } from "./sources";
import type { FromWorker, ToWorker } from "./worker";

const SLOW = /^api\/v1\/grids\/[^/]+\/(view\.|stats|diff|line|column|box\.|slice)/;

interface Waiting {
  resolve(message: FromWorker): void;
  reject(error: unknown): void;
}

class Helper {
  private readonly worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
  private readonly waiting = new Map<number, Waiting>();
  private next = 0;
  constructor(
    module: Promise<WebAssembly.Module>,
    private readonly files: readonly KeptBytes[],
  ) {
    this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => this.take(data);
    module.then(
      (compiled) => this.tell({ kind: "module", module: compiled }),
      () => {}, // open() says it
    );
  }

  // What the worker answers to a message, which gets an id.
  ask(message: { kind: "ask"; target: string } | { kind: "open"; name: string; size: number }, signal?: AbortSignal | null): Promise<FromWorker> {
    const id = this.next++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      signal?.addEventListener("abort", () => this.give_up(id, signal.reason));
      this.tell({ ...message, id });
    });
  }

  private take(message: FromWorker): void {
    if (message.kind === "wanted") return void this.fetch(message.id, message.missing);
    this.waiting.get(message.id)?.resolve(message);
    this.waiting.delete(message.id);
  }
  private async fetch(id: number, missing: readonly Missing[]): Promise<void> {
    try {
      const parts = await Promise.all(
        missing.map(async ({ file, offset, size }) => ({ file, offset, bytes: await this.files[file]!.read(offset, size) })),
      );
      this.tell({ kind: "bytes", id, parts }, parts.map(({ bytes }) => bytes.buffer));
    } catch (error) {
      this.give_up(id, error);
    }
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

export class LocalGrids {
  private readonly files: KeptBytes[] = [];
  private readonly ids = new Set<string>();
  private readonly unreadable: UnreadableFile[] = [];
  private readonly module = compiled();
  private readonly helpers = [new Helper(this.module, this.files), new Helper(this.module, this.files)] as const;

  // Makes them the ones who answer about their grids. `alone`: there is no server.
  constructor(private readonly alone: boolean) {
    answer_by((before) => (path, options) => this.answer(path, options, before));
  }

  // Adds a grid, and returns its id; or null when it can't be read, which the list of grids then says.
  async add(open: () => Promise<Source>, name: string): Promise<string | null> {
    try {
      await this.module;
      const source = await open();
      this.files.push(new KeptBytes(source));
      const before = (await this.list()).map(({ id }) => id);
      const opened = await Promise.all(this.helpers.map((helper) => helper.ask({ kind: "open", name: source.name, size: source.size })));
      for (const message of opened) {
        if (message.kind === "failed") throw new Error(message.message);
        if (message.kind === "opened" && message.wrong) throw new Error(message.wrong);
      }
      const added = (await this.list()).find(({ id }) => !before.includes(id))!.id;
      this.ids.add(added);
      return added;
    } catch (error) {
      this.unreadable.push({ id: name.replace(/\.tcell$/, ""), error: error instanceof Error ? error.message : String(error) });
      return null;
    }
  }

  private async list(): Promise<GridSummary[]> {
    const message = await this.helpers[0].ask({ kind: "ask", target: "/api/v1/grids" });
    return message.kind === "answer" ? (JSON.parse(new TextDecoder().decode(message.answer.body)) as { grids: GridSummary[] }).grids : [];
  }

  private async answer(path: string, options: Parameters<Ask>[1], before: Ask): Promise<Response> {
    if (path === "api/v1/grids") {
      const served = this.alone ? { grids: [], unreadable: [] } : await before(path, options).then((response) => response.json());
      return json(200, { ...served, grids: [...served.grids, ...(await this.list())], unreadable: [...served.unreadable, ...this.unreadable] });
    }
    const id = decodeURIComponent(/^api\/v1\/grids\/([^/?]+)/.exec(path)?.[1] ?? "");
    if (!this.alone && !this.ids.has(id)) return before(path, options);
    if (path === "healthz") return new Response("ok");
    const helper = this.helpers[SLOW.test(path) ? 1 : 0];
    options.signal?.throwIfAborted();
    try {
      const message = await helper.ask({ kind: "ask", target: `/${path}` }, options.signal);
      if (message.kind === "answer") return response_of(message.answer);
      return failure(500, "failed", message.kind === "failed" ? message.message : "the module gave another answer");
    } catch (error) {
      if (!(error instanceof SourceError)) throw error;
      if (error.code === "unreachable") throw new TypeError(error.message);
      return failure(500, error.code, error.message);
    }
  }
}

async function compiled(): Promise<WebAssembly.Module> {
  if (module_address === null) throw new Error("this page was built without the module that reads grids");
  const response = await fetch(module_address);
  return WebAssembly.compile(await response.arrayBuffer());
}
