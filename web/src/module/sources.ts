// Where the bytes of a grid come from: a host that answers ranges, or a file that the user has given to the page.

export interface Source {
  readonly size: number;
  read(offset: number, size: number): Promise<Uint8Array<ArrayBuffer>>;
}

// Where a source is, to be passed to a worker. `found`: what the host has said of the file, once it was asked.
export type Place =
  | { readonly kind: "address"; readonly address: string; readonly found: Found | null }
  | { readonly kind: "file"; readonly file: Blob; readonly name: string }
  | HeldPlace;
export type HeldPlace = { readonly kind: "page"; readonly grid: number; readonly size: number }; // held.ts

export interface Found {
  readonly size: number;
  readonly version: string | null;
}

// Bytes can't be had. `code` is that of an answer of the server in the same case.
export class SourceError extends Error {
  grid: string | null = null; // whose bytes they are, by its id
  constructor(
    readonly code: "unreachable" | "replaced" | "unreadable",
    message: string,
  ) {
    super(message);
  }
}

const file_source = (file: Blob, name: string): Source => ({
  size: file.size,
  async read(offset, size) {
    const bytes = await file
      .slice(offset, offset + size)
      .arrayBuffer()
      .catch(() => null);
    if (bytes?.byteLength !== size)
      throw new SourceError("replaced", `${name}: the file was changed, moved or removed since it was given to this page: give it again`);
    return new Uint8Array(bytes);
  },
});

const shown = (url: URL) => url.host || url.protocol;
function last_part(url: URL): string {
  const name = url.pathname.split("/").pop() || url.host;
  try {
    return decodeURIComponent(name);
  } catch {
    return name; // its bytes are no UTF-8
  }
}

// What a host must allow so that a page of another origin may read its files.
const ALLOWANCE = "it must allow this page's origin and the header Range, and expose Content-Range and ETag (CORS)";

export class HttpSource implements Source {
  readonly size: number;
  private readonly name: string;
  constructor(
    private readonly url: URL,
    readonly found: Found,
  ) {
    this.size = found.size;
    this.name = last_part(url);
  }

  // Asks for the size first. Ranges from the end, which would tell it, too, are refused by some hosts.
  static async open(url: URL): Promise<HttpSource> {
    const head = await asked(url, { method: "HEAD" });
    if (!head.ok) throw new SourceError("unreadable", `${last_part(url)}: ${shown(url)} answered ${head.status} ${head.statusText}`.trim());
    const size = Number(head.headers.get("content-length") ?? Number.NaN);
    if (!Number.isSafeInteger(size)) throw new SourceError("unreadable", `${last_part(url)}: ${shown(url)} does not tell its size (Content-Length)`);
    return new HttpSource(url, { size, version: version_of(head) });
  }

  async read(offset: number, size: number): Promise<Uint8Array<ArrayBuffer>> {
    const range = `bytes=${offset}-${offset + size - 1}`;
    const response = await asked(this.url, { headers: { range } });
    const version = version_of(response);
    if (response.status === 416 || (version !== null && this.found.version !== null && version !== this.found.version))
      throw new SourceError("replaced", `${this.name}: ${shown(this.url)} has another file under this address now: load the page again`);
    if (response.status === 200 && size < this.size) {
      void response.body?.cancel();
      throw new SourceError("unreadable", `${this.name}: ${shown(this.url)} sends whole files only; a host that answers ranges of bytes is needed`);
    }
    if (!response.ok) throw new SourceError("unreadable", `${this.name}: ${shown(this.url)} answered ${response.status} ${response.statusText}`.trim());
    const sent = response.headers.get("content-range");
    if (sent !== null && !sent.startsWith(`bytes ${offset}-`))
      throw new SourceError("unreadable", `${this.name}: asked for ${range}, ${shown(this.url)} sent ${sent}`);
    const bytes = new Uint8Array(await body_of(response, this.url));
    if (bytes.length !== size)
      throw new SourceError("unreadable", `${this.name}: expected ${size} bytes from byte ${offset}, and ${shown(this.url)} sent ${bytes.length}`);
    return bytes;
  }
}

// Strong ETags alone tell that bytes are the same.
function version_of(response: Response): string | null {
  const etag = response.headers.get("etag");
  return etag === null || etag.startsWith("W/") ? null : etag;
}

const LONGEST = 15_000; // milliseconds until a host begins to answer

async function asked(url: URL, options: RequestInit): Promise<Response> {
  const stalled = new AbortController();
  const timer = setTimeout(() => stalled.abort(), LONGEST);
  try {
    return await fetch(url, { ...options, signal: stalled.signal });
  } catch {
    const why = stalled.signal.aborted ? `has not answered within ${LONGEST / 1000} s` : `can't be reached, or does not let this page read it: ${ALLOWANCE}`;
    throw new SourceError("unreachable", `${last_part(url)}: ${shown(url)} ${why}`);
  } finally {
    clearTimeout(timer);
  }
}

async function body_of(response: Response, url: URL): Promise<ArrayBuffer> {
  try {
    return await response.arrayBuffer();
  } catch {
    throw new SourceError("unreachable", `${last_part(url)}: the connection to ${shown(url)} broke off`);
  }
}

// `held`: those that are in the page. Throws SourceError.
export async function source_at(place: Place, held: (place: HeldPlace) => Source): Promise<Source> {
  if (place.kind === "page") return held(place);
  if (place.kind === "file") return file_source(place.file, place.name);
  const url = new URL(place.address);
  return place.found ? new HttpSource(url, place.found) : HttpSource.open(url);
}
