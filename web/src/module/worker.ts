// A worker with a module of its own. It is told of grids, is asked for answers, and fetches the bytes that an answer needs by itself, so that
// nothing waits for the page, which is busy drawing. While an answer waits for bytes, others are made.
import { type Answer, Instance, type Missing, is_missing } from "./instance";
import { KeptBytes } from "./kept_bytes";
import { FileSource, HttpSource, type Place, type Source, SourceError } from "./sources";

export type ToWorker =
  | { kind: "module"; code: ArrayBuffer } // not compiled: Chromium gives no compiled module to a worker of a page from a disk
  | { kind: "open"; id: number; place: Place }
  | { kind: "ask"; id: number; target: string }
  | { kind: "bytes"; id: number; bytes: Uint8Array<ArrayBuffer> | string } // what was wanted, or what is wrong with it
  | { kind: "forget"; id: number }; // nobody waits for the answer any more

export type FromWorker =
  | { kind: "opened"; id: number; wrong: string }
  | { kind: "answer"; id: number; answer: Answer }
  | { kind: "wanted"; id: number; grid: number; offset: number; size: number } // of a grid that is in the page; `id` is the worker's
  | { kind: "failed"; id: number; code: SourceError["code"] | null; message: string }; // null: the module broke down

const send = (message: FromWorker, transfer: Transferable[] = []) => (self as unknown as Worker).postMessage(message, transfer);

// A grid in the page.
const asked = new Map<number, (bytes: Uint8Array<ArrayBuffer> | string) => void>();
let next = 0;
class PageSource implements Source {
  constructor(
    private readonly grid: number,
    readonly name: string,
    readonly size: number,
  ) {}
  async read(offset: number, size: number): Promise<Uint8Array<ArrayBuffer>> {
    const id = next++;
    const bytes = await new Promise<Uint8Array<ArrayBuffer> | string>((resolve) => {
      asked.set(id, resolve);
      send({ kind: "wanted", id, grid: this.grid, offset, size });
    });
    if (typeof bytes === "string") throw new SourceError("unreadable", bytes);
    return bytes;
  }
}

function source_at(place: Place): Source {
  if (place.kind === "address") return new HttpSource(new URL(place.address), place.size, place.version);
  if (place.kind === "file") return new FileSource(place.file, place.name);
  return new PageSource(place.grid, place.name, place.size);
}

let start: (instance: Promise<Instance>) => void;
const ready = new Promise<Instance>((resolve) => (start = resolve));
const begun = async (code: ArrayBuffer) => {
  try {
    return await Instance.of(await WebAssembly.compile(code));
  } catch (error) {
    throw new Error(`the module that reads grids can't be started: ${error instanceof Error ? error.message : String(error)}`);
  }
};
const kept = new KeptBytes();
const waiting = new Set<number>(); // answers that are being made

// Calls make() until all bytes that it needs are there; null when nobody waits for it any more.
async function until_there<T extends object>(instance: Instance, id: number, make: () => T | readonly Missing[]): Promise<T | null> {
  for (;;) {
    const outcome = make();
    if (!is_missing(outcome)) return outcome;
    const fetched = outcome.map(async ({ file, offset, size }) => ({ file, offset, bytes: await kept.read(file, offset, size) }));
    const parts = await Promise.all(fetched);
    if (!waiting.has(id)) return null;
    for (const { file, offset, bytes } of parts) instance.give(file, offset, bytes);
  }
}

async function open(instance: Instance, id: number, place: Place): Promise<void> {
  const source = source_at(place);
  const file = instance.add(source.name, source.size);
  kept.add(file, source);
  const opened = await until_there(instance, id, () => instance.open(file));
  if (opened) send({ kind: "opened", id, wrong: opened.wrong });
}

async function ask(instance: Instance, id: number, target: string): Promise<void> {
  const answer = await until_there(instance, id, () => instance.answer(target));
  if (answer) send({ kind: "answer", id, answer }, [answer.body.buffer]);
}

self.onmessage = async ({ data }: MessageEvent<ToWorker>) => {
  if (data.kind === "module") return start(begun(data.code));
  const { id } = data;
  if (data.kind === "bytes") {
    asked.get(id)?.(data.bytes);
    asked.delete(id);
    return;
  }
  if (data.kind === "forget") return void waiting.delete(id);
  waiting.add(id);
  try {
    const instance = await ready;
    await (data.kind === "open" ? open(instance, id, data.place) : ask(instance, id, data.target));
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    send({ kind: "failed", id, code: error instanceof SourceError ? error.code : null, message });
  }
  waiting.delete(id);
  if (waiting.size === 0) await ready.then((instance) => instance.rest(), () => {}); // it was said above
};
