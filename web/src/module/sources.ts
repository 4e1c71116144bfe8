// Where the bytes of a grid come from: a host that answers ranges, or a file that the user has given to the page.

export interface Source {
  readonly name: string; // that of the file
  readonly size: number;
  read(offset: number, size: number, signal?: AbortSignal): Promise<Uint8Array<ArrayBuffer>>;
}

// Where a source is, to be passed to a worker.
export type Place =
  | { readonly kind: "address"; readonly address: string; readonly size: number; readonly version: string | null }
  | { readonly kind: "file"; readonly file: Blob; readonly name: string }
  | { readonly kind: "page"; readonly grid: number; readonly name: string; readonly size: number }; // held.ts

// A source, and where it is.
export interface Placed {
  readonly source: Source;
  readonly place: Place;
}

// Bytes can't be had. `code` is that of an answer of the server in the same case.
export class SourceError extends Error {
  constructor(
    readonly code: "unreachable" | "replaced" | "unreadable",
    message: string,
  ) {
    super(message);
  }
}

export class FileSource implements Source {
  constructor(
    private readonly blob: Blob,
    readonly name: string,
  ) {}
  get size(): number {
    return this.blob.size;
  }
  async read(offset: number, size: number): Promise<Uint8Array<ArrayBuffer>> {
    const bytes = await this.blob
      .slice(offset, offset + size)
      .arrayBuffer()
      .catch(() => null);
    if (bytes?.byteLength !== size)
      throw new SourceError("replaced", `${this.name}: the file was changed, moved or removed since it was given to this page: give it again`);
    return new Uint8Array(bytes);
  }
}

const shown = (url: URL) => url.host || url.protocol;
const last_part = (url: URL) => decodeURIComponent(url.pathname.split("/").pop() || url.host);

// What a host must allow so that a page of another origin may read its files.
const ALLOWANCE = "it must allow this page's origin and the header Range, and expose Content-Range and ETag (CORS)";

export class HttpSource implements Source {
  constructor(
    private readonly url: URL,
    readonly size: number,
    private readonly version: string | null,
  ) {}
  get name(): string {
    return last_part(this.url);
  }

  // Asks for the size first. Ranges from the end, which would tell it, too, are refused by some hosts.
  static async open(url: URL): Promise<Placed> {
    const head = await asked(url, { method: "HEAD" });
    if (!head.ok) throw new SourceError("unreadable", `${last_part(url)}: ${shown(url)} answered ${head.status} ${head.statusText}`.trim());
    const size = Number(head.headers.get("content-length") ?? Number.NaN);
    if (!Number.isSafeInteger(size)) throw new SourceError("unreadable", `${last_part(url)}: ${shown(url)} does not tell its size (Content-Length)`);
    const version = version_of(head);
    return { source: new HttpSource(url, size, version), place: { kind: "address", address: url.href, size, version } };
  }

  async read(offset: number, size: number, signal?: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    const range = `bytes=${offset}-${offset + size - 1}`;
    const response = await asked(this.url, { headers: { range }, ...(signal && { signal }) });
    const version = version_of(response);
    if (response.status === 416 || (version !== null && this.version !== null && version !== this.version))
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

async function asked(url: URL, options: RequestInit): Promise<Response> {
  try {
    return await fetch(url, options);
  } catch (error) {
    if (options.signal?.aborted) throw error;
    throw new SourceError("unreachable", `${last_part(url)}: ${shown(url)} can't be reached, or does not let this page read it: ${ALLOWANCE}`);
  }
}

async function body_of(response: Response, url: URL): Promise<ArrayBuffer> {
  try {
    return await response.arrayBuffer();
  } catch {
    throw new SourceError("unreachable", `${last_part(url)}: the connection to ${shown(url)} broke off`);
  }
}
