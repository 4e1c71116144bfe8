// A worker with a module of its own. It is told of grids, is asked for answers, and fetches the bytes that an answer needs by itself, so that
// nothing waits for the page, which is busy drawing. While an answer waits for bytes, others are made.
import { type Answer, Instance, type Missing, is_missing } from "./instance";
import { KeptBytes } from "./kept_bytes";
import { type HeldPlace, HttpSource, type Place, type Source, SourceError, source_at } from "./sources";

export type ToWorker =
  | { kind: "module"; code: string | Uint8Array<ArrayBuffer> } // compressed, or its address; no worker of a page from a disk gets one that is compiled
  | { kind: "open"; id: number; place: Place; as: string } // the file's name, whose stem becomes the grid's id if no other has it
  | { kind: "ask"; id: number; target: string }
  | { kind: "bytes"; id: number; bytes: Uint8Array<ArrayBuffer> | string } // what was wanted, or what is wrong with it
  | { kind: "forget"; id: number }; // nobody waits for the answer any more

export type FromWorker =
  | { kind: "opened"; id: number; wrong: boolean; text: string; place: Place } // the grid's id, or what is wrong; where it is in full
  | { kind: "answer"; id: number; answer: Answer }
  | { kind: "wanted"; id: number; grid: number; offset: number; size: number } // of a grid that is in the page; `id` is the worker's
  // `code`: null if the module broke down. `grid`: whose bytes can't be had.
  | { kind: "failed"; id: number; code: SourceError["code"] | null; message: string; grid: string | null };

const send = (message: FromWorker, transfer: Transferable[] = []) => (self as unknown as Worker).postMessage(message, transfer);

// A grid in the page.
const asked = new Map<number, (bytes: Uint8Array<ArrayBuffer> | string) => void>();
let next = 0;
const page_source = ({ grid, size: all }: HeldPlace): Source => ({
  size: all,
  async read(offset, size) {
    const id = next++;
    const bytes = await new Promise<Uint8Array<ArrayBuffer> | string>((resolve) => {
      asked.set(id, resolve);
      send({ kind: "wanted", id, grid, offset, size });
    });
    if (typeof bytes === "string") throw new SourceError("unreadable", bytes);
    return bytes;
  },
});

let start: (instance: Promise<Instance>) => void;
const ready = new Promise<Instance>((resolve) => (start = resolve));
async function begun(code: string | Uint8Array<ArrayBuffer>): Promise<Instance> {
  const packed = typeof code === "string" ? await fetched(code) : new Response(code);
  const bytes = await new Response(packed.body!.pipeThrough(new DecompressionStream("gzip"))).arrayBuffer().catch(() => {
    throw new Error("the part of this page that reads grids is cut or damaged: get the page again");
  });
  try {
    return await Instance.of(await WebAssembly.compile(bytes));
  } catch (error) {
    throw new Error(`the module that reads grids can't be started: ${message_of(error)}`);
  }
}
async function fetched(address: string): Promise<Response> {
  const response = await fetch(address).catch(() => null);
  if (response?.ok) return response;
  const why = response ? `${response.status} ${response.statusText}`.trim() : "its host can't be reached";
  throw new Error(`a part of this page, ${address.split("/").pop()!}, can't be loaded: ${why}`);
}
const message_of = (error: unknown) => (error instanceof Error ? error.message : String(error));
const kept = new KeptBytes();
const files: { readonly kept_as: number; grid: string | null }[] = []; // by the module's numbers
const waiting = new Set<number>(); // answers that are being made

// Calls make() until all bytes that it needs are there; null when nobody waits for it any more.
async function until_there<T extends object>(instance: Instance, id: number, make: () => T | readonly Missing[]): Promise<T | null> {
  for (;;) {
    const outcome = make();
    if (!is_missing(outcome)) return outcome;
    const fetched = outcome.map(async ({ file, offset, size }) => {
      const { kept_as, grid } = files[file]!;
      try {
        return { file, offset, bytes: await kept.read(kept_as, offset, size) };
      } catch (error) {
        if (error instanceof SourceError) error.grid = grid;
        throw error;
      }
    });
    const parts = await Promise.all(fetched);
    if (!waiting.has(id)) return null;
    for (const { file, offset, bytes } of parts) instance.give(file, offset, bytes);
  }
}

async function open(id: number, place: Place, as: string): Promise<void> {
  const source = await source_at(place, page_source);
  const kept_as = kept.add(source); // which begins to read, while the module is still on its way
  const instance = await ready;
  const file = instance.add(as, source.size);
  files[file] = { kept_as, grid: null };
  const opened = await until_there(instance, id, () => instance.open(file));
  if (!opened) return;
  if (!opened.wrong) files[file].grid = opened.text;
  const full = source instanceof HttpSource && place.kind === "address" ? { ...place, found: source.found } : place;
  send({ kind: "opened", id, place: full, ...opened });
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
    await (data.kind === "open" ? open(id, data.place, data.as) : ask(await ready, id, data.target));
  } catch (error) {
    const { code, grid } = error instanceof SourceError ? error : { code: null, grid: null };
    send({ kind: "failed", id, code, message: message_of(error), grid });
  }
  waiting.delete(id);
  if (waiting.size === 0) await ready.then((instance) => instance.rest(), () => {}); // it was said above
};
