// A worker with a module of its own. It is told of files, is asked for answers, and asks for bytes of the files when it needs some. While an
// answer waits for bytes, others are made.
import { type Answer, Instance, type Missing, is_missing } from "./instance";

export type ToWorker =
  | { kind: "module"; code: ArrayBuffer } // not compiled: Chromium gives no compiled module to a worker of a page from a disk
  | { kind: "open"; id: number; name: string; size: number }
  | { kind: "ask"; id: number; target: string }
  | { kind: "bytes"; id: number; parts: { offset: number; file: number; bytes: Uint8Array<ArrayBuffer> }[] }
  | { kind: "forget"; id: number }; // nobody waits for the answer, or its bytes could not be had

export type FromWorker =
  | { kind: "wanted"; id: number; missing: readonly Missing[] }
  | { kind: "opened"; id: number; wrong: string }
  | { kind: "answer"; id: number; answer: Answer }
  | { kind: "failed"; id: number; message: string }; // the module broke down

let start: (instance: Instance) => void;
const ready = new Promise<Instance>((resolve) => (start = resolve));
const waiting = new Map<number, (instance: Instance) => void>(); // what to do again once bytes have come

const send = (message: FromWorker, transfer: Transferable[] = []) => (self as unknown as Worker).postMessage(message, transfer);

function attempt(instance: Instance, id: number, make: () => { missing: readonly Missing[] } | null): void {
  let missing: readonly Missing[] | null = null;
  try {
    missing = make()?.missing ?? null;
  } catch (error) {
    send({ kind: "failed", id, message: error instanceof Error ? error.message : String(error) });
  }
  if (missing) send({ kind: "wanted", id, missing });
  else waiting.delete(id);
  if (waiting.size === 0) instance.rest();
}

function begin(instance: Instance, id: number, make: () => { missing: readonly Missing[] } | null): void {
  const again = (of: Instance) => attempt(of, id, make);
  waiting.set(id, again);
  again(instance);
}

self.onmessage = async ({ data }: MessageEvent<ToWorker>) => {
  if (data.kind === "module") return start(await Instance.of(await WebAssembly.compile(data.code)));
  const instance = await ready;
  const { id } = data;
  if (data.kind === "open") {
    const file = instance.add(data.name, data.size);
    begin(instance, id, () => {
      const outcome = instance.open(file);
      if (is_missing(outcome)) return { missing: outcome };
      send({ kind: "opened", id, wrong: outcome.wrong });
      return null;
    });
  } else if (data.kind === "ask") {
    begin(instance, id, () => {
      const answer = instance.answer(data.target);
      if (is_missing(answer)) return { missing: answer };
      send({ kind: "answer", id, answer }, [answer.body.buffer]);
      return null;
    });
  } else if (data.kind === "bytes") {
    for (const { file, offset, bytes } of data.parts) instance.give(file, offset, bytes);
    waiting.get(id)?.(instance);
  } else {
    waiting.delete(id);
    if (waiting.size === 0) instance.rest();
  }
};
