// Bytes of a source, in blocks. What was read is kept, up to a bound; what is under way is not asked for again.
import type { Source } from "./sources";

const BLOCK = 16384; // as in web/module/page_file.hpp
const KEPT = 8 << 20; // the module keeps more

export class KeptBytes {
  private readonly blocks = new Map<number, Uint8Array<ArrayBuffer>>(); // those that were read last come last
  private readonly under_way = new Map<number, Promise<void>>();
  private bytes = 0;
  constructor(private readonly source: Source) {}

  // REQUIRES: whole blocks, the last one as long as the source has it.
  async read(offset: number, size: number): Promise<Uint8Array<ArrayBuffer>> {
    const [first, end] = [offset / BLOCK, Math.ceil((offset + size) / BLOCK)];
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
          const fetched = this.fetch(b, last, mine);
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

  private async fetch(first: number, end: number, into: Map<number, Uint8Array<ArrayBuffer>>): Promise<void> {
    const offset = first * BLOCK;
    const size = Math.min(end * BLOCK, this.source.size) - offset;
    try {
      const bytes = await this.source.read(offset, size);
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
