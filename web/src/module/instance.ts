// The module (web/module/module.cpp): the program's own answers, in this page. A call never waits. Where bytes of a file are missing it says
// which, and is to be called again when they have been given.
//
// It comes without JavaScript of its own. Of its surroundings it needs memory alone; whatever else its libraries could ask for (files,
// a clock, an environment) is not there, and they are told so.

export interface Missing {
  readonly file: number;
  readonly offset: number;
  readonly size: number;
}

export interface Answer {
  readonly status: number;
  readonly type: string;
  readonly etag: string;
  readonly body: Uint8Array<ArrayBuffer>;
}

export const is_missing = <T extends object>(outcome: T | readonly Missing[]): outcome is readonly Missing[] => Array.isArray(outcome);

interface Exports {
  readonly memory: WebAssembly.Memory;
  _initialize(): void;
  room(bytes: number): number;
  add_file(size: number): number;
  open_file(file: number): number;
  answer(): number;
  status(): number;
  content_type(): number;
  etag(): number;
  body_data(): number;
  body_size(): number;
  missing_count(): number;
  missing_file(i: number): number;
  missing_offset(i: number): number;
  missing_size(i: number): number;
  give(file: number, offset: number): void;
  rest(): void;
}

const NO_SYSTEM_CALL = 52; // ENOSYS

// A function for each import: system calls fail, and the end of the program is an exception. Tables are hashed with random seeds.
function surroundings(module: WebAssembly.Module, memory: () => WebAssembly.Memory): WebAssembly.Imports {
  const known: Record<string, WebAssembly.ImportValue> = {
    emscripten_notify_memory_growth: () => {},
    proc_exit: (code: number) => {
      throw new Error(`the module ended with status ${code}`);
    },
    getentropy: (at: number, bytes: number) => {
      crypto.getRandomValues(new Uint8Array(memory().buffer, at, bytes));
      return 0;
    },
  };
  const out: WebAssembly.Imports = {};
  for (const { module: space, name } of WebAssembly.Module.imports(module)) {
    const fail = space.startsWith("wasi") ? NO_SYSTEM_CALL : -NO_SYSTEM_CALL;
    (out[space] ??= {})[name] = known[name] ?? (() => fail);
  }
  return out;
}

export class Instance {
  private constructor(private readonly exports: Exports) {}

  static async of(module: WebAssembly.Module): Promise<Instance> {
    let exports: Exports | null = null;
    const instance = await WebAssembly.instantiate(
      module,
      surroundings(module, () => exports!.memory),
    );
    exports = instance.exports as unknown as Exports;
    exports._initialize();
    return new Instance(exports);
  }

  get memory(): number {
    return this.exports.memory.buffer.byteLength;
  }

  // Makes a file known. It is a grid once it has been opened.
  add(name: string, size: number): number {
    this.put(new TextEncoder().encode(name));
    return this.exports.add_file(size);
  }
  // The id of the grid that a file holds, or what is wrong with the file.
  open(file: number): { readonly wrong: boolean; readonly text: string } | readonly Missing[] {
    if (this.exports.open_file(file) !== 0) return this.missing();
    return { wrong: this.exports.status() !== 200, text: new TextDecoder().decode(this.body()) };
  }
  answer(target: string): Answer | readonly Missing[] {
    this.put(new TextEncoder().encode(target));
    if (this.exports.answer() !== 0) return this.missing();
    const { status, content_type, etag } = this.exports;
    return { status: status(), type: this.text(content_type()), etag: this.text(etag()), body: this.body() };
  }
  // Bytes that were missing, from where they were missing.
  give(file: number, offset: number, bytes: Uint8Array): void {
    this.put(bytes);
    this.exports.give(file, offset);
  }
  // To be called when nobody waits for bytes: those that were not used for long may go.
  rest(): void {
    this.exports.rest();
  }

  private put(bytes: Uint8Array): void {
    const at = this.exports.room(bytes.length);
    new Uint8Array(this.exports.memory.buffer, at, bytes.length).set(bytes);
  }
  private body(): Uint8Array<ArrayBuffer> {
    return new Uint8Array(this.exports.memory.buffer, this.exports.body_data(), this.exports.body_size()).slice();
  }
  private text(at: number): string {
    const bytes = new Uint8Array(this.exports.memory.buffer, at);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }
  private missing(): readonly Missing[] {
    const { missing_count, missing_file, missing_offset, missing_size } = this.exports;
    return Array.from({ length: missing_count() }, (_, i) => ({ file: missing_file(i), offset: missing_offset(i), size: missing_size(i) }));
  }
}
