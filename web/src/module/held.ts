// What an HTML file holds in elements that show nothing: which grids the page has, and in a page that is one file the grids themselves.
// `teracell page` writes the same (server/page/static_page.cpp).
//
//   <script id="grids" type="application/json">[{"name": "bust.tcell", "bytes": 98304, "checked": "... its hash ..."}]</script>
//   <script id="findings-0" type="application/json">{... what "teracell check" has found in it ...}</script>
//   <script type="text/plain" class="grid-0">... base64 of 49,152 bytes ...</script>
//   <script type="text/plain" class="grid-0">...</script>
import { type Source, SourceError } from "./sources";

// Of one piece. Browsers cut longer texts into nodes of 65,536 characters, and would join them again each time that they are read.
export const PIECE = 49152;

// Of a grid in a page: browsers hold all of it in memory.
export const MOST_HELD = 256 << 20;

// A grid of the page's own list: at an address, which may be relative, or in the page itself. `checked`: its hash, if what was found in it is
// there: in a file beside it ("bust.check.json"), or in an element of the page.
export type ListedGrid = ({ readonly name: string; readonly address: string } | { readonly name: string; readonly bytes: number }) & {
  readonly checked?: string;
};

const LIST = /(<script id="grids" type="application\/json">).*?(<\/script>)/s;

export const held_text = (id: string): string => document.getElementById(id)?.textContent ?? "";

// The grids that the page was written with; null: it came from a server, which has some.
export const listed_grids = (): readonly ListedGrid[] | null => JSON.parse(held_text("grids") || "null") as readonly ListedGrid[] | null;

export function bytes_of(base64: string): Uint8Array<ArrayBuffer> {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// A grid in the page. Pieces are decoded when they are read.
export class HeldSource implements Source {
  private readonly pieces: readonly Element[];
  constructor(
    number: number,
    private readonly name: string,
    readonly size: number,
  ) {
    this.pieces = [...document.getElementsByClassName(`grid-${number}`)];
  }

  read(offset: number, size: number): Promise<Uint8Array<ArrayBuffer>> {
    const out = new Uint8Array(size);
    for (let at = offset; at < offset + size; ) {
      const number = Math.floor(at / PIECE);
      const piece = this.piece(number);
      const part = piece.subarray(at - number * PIECE, offset + size - number * PIECE);
      out.set(part, at - offset);
      at += part.length;
    }
    return Promise.resolve(out);
  }

  private piece(number: number): Uint8Array<ArrayBuffer> {
    const expected = Math.min(PIECE, this.size - number * PIECE);
    let found: Uint8Array | string;
    try {
      const bytes = bytes_of(this.pieces[number]?.textContent ?? "");
      if (bytes.length === expected) return bytes;
      found = `${bytes.length} bytes`;
    } catch {
      found = "what is not base64";
    }
    throw new SourceError("unreadable", `this page is cut or damaged: piece ${number} of ${this.name} is to have ${expected} bytes, and has ${found}`);
  }
}

async function base64_of(bytes: Uint8Array<ArrayBuffer>): Promise<string> {
  const reader = new FileReader();
  const read = new Promise((resolve, reject) => ((reader.onload = resolve), (reader.onerror = reject)));
  reader.readAsDataURL(new Blob([bytes]));
  await read;
  return (reader.result as string).split(",")[1] ?? "";
}

const in_element = (json: string) => json.replaceAll("<", "\\u003c");

// The page with a grid in it, as one HTML file. `page`: that file without a grid. `checked`: the grid's hash, and what was
// found in it.
export async function page_with(page: string, name: string, grid: Blob, checked: { hash: string; findings: string } | null): Promise<Blob> {
  const found = LIST.exec(page);
  if (!found) throw new Error("the page has no place for a grid: load it again");
  const list = JSON.stringify([{ name, bytes: grid.size, ...(checked && { checked: checked.hash }) } satisfies ListedGrid]);
  const parts: BlobPart[] = [page.slice(0, found.index), found[1]!, in_element(list), found[2]!];
  if (checked) parts.push('\n<script id="findings-0" type="application/json">', in_element(checked.findings), "</script>");
  for (let at = 0; at < grid.size; at += PIECE)
    parts.push('\n<script type="text/plain" class="grid-0">', await base64_of(new Uint8Array(await grid.slice(at, at + PIECE).arrayBuffer())), "</script>");
  return new Blob([...parts, page.slice(found.index + found[0].length)], { type: "text/html" });
}
