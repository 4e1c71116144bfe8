// Bytes of sources, in blocks. What was read is kept, up to a bound; what is under way is not asked for again.
import type { Source } from "./sources";

const BLOCK = 16384; // as in web/module/page_file.hpp
const KEPT = 8 << 20; // of all sources; the module keeps more
const AT_THE_END = 2; // blocks
const FILE = 2 ** 32; // keys of blocks that a source has room for

export class KeptBytes {
  private readonly sources: Source[] = [];
  private readonly blocks = new Map<number, Uint8Array<ArrayBuffer>>(); // those that were read last come last
  private readonly under_way = new Map<number, Promise<void>>();
  private bytes = 0;

  // Returns the source's number here. Its first and its last bytes are read at once, since every reader begins with these.
  add(source: Source): number {
    const file = this.sources.push(source) - 1;
    const end = Math.max(0, Math.ceil(source.size / BLOCK) - AT_THE_END) * BLOCK;
    for (const at of new Set([0, end]))
      if (at < source.size) this.read(file, at, Math.min(source.size, at + AT_THE_END * BLOCK) - at).catch(() => {}); // said when they are wanted
    return file;
  }

  // REQUIRES: whole blocks, the last one as long as the source has it.
  async read(file: number, offset: number, size: number): Promise<Uint8Array<ArrayBuffer>> {
    const [first, end] = [file * FILE + offset / BLOCK, file * FILE + Math.ceil((offset + size) / BLOCK)];
    const mine = new Map<number, Uint8Array<ArrayBuffer>>();
    for (;;) {
      const waits: Promise<void>[] = [];
      for (let b = first; b < end; ++b) {
        const found = this.blocks.get(b);
        if (found) mine.set(b, found);
        if (mine.has(b)) continue;
        const coming = this.under_way.get(b);
        if (coming) waits.push(coming);
        else {
          let last = b + 1;
          while (last < end && !this.blocks.has(last) && !this.under_way.has(last) && !mine.has(last)) ++last;
          const fetched = this.fetch(file, b, last, mine);
          for (let i = b; i < last; ++i) this.under_way.set(i, fetched);
          waits.push(fetched);
          b = last - 1;
        }
      }
      if (waits.length === 0) break;
      await Promise.all(waits);
    }
    const out = new Uint8Array(size);
    for (let b = first; b < end; ++b) out.set(mine.get(b)!, (b - first) * BLOCK);
    return out;
  }

  private async fetch(file: number, first: number, end: number, into: Map<number, Uint8Array<ArrayBuffer>>): Promise<void> {
    const source = this.sources[file]!;
    const offset = (first - file * FILE) * BLOCK;
    const size = Math.min(offset + (end - first) * BLOCK, source.size) - offset;
    try {
      const bytes = await source.read(offset, size);
      for (let b = first; b < end; ++b) {
        const block = bytes.slice((b - first) * BLOCK, (b - first + 1) * BLOCK);
        into.set(b, block);
        this.blocks.set(b, block);
        this.bytes += block.length;
      }
      for (const [b, block] of this.blocks) {
        if (this.bytes <= KEPT) break;
        this.blocks.delete(b);
        this.bytes -= block.length;
      }
    } finally {
      for (let b = first; b < end; ++b) this.under_way.delete(b);
    }
  }
}
