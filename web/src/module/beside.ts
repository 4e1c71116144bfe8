// Where the page finds what is not loaded with it: in files beside it. Where the whole page is one file, inside.ts takes the place of this
// (vite.config.ts).
import module_address from "virtual:module";

async function fetched(address: string): Promise<Response> {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${address.split("/").pop()!} can't be loaded: ${response.status} ${response.statusText}`.trim());
  return response;
}

// The module that reads grids (web/module), compressed with gzip; null: the page was built without it.
export const module_bytes = module_address ? async () => new Uint8Array(await (await fetched(module_address!)).arrayBuffer()) : null;

export const make_worker = (): Worker => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });

// The page as one HTML file, in which grids can be put (held.ts); null: there is none.
export const whole_page = module_address ? async () => (await fetched("whole.html")).text() : null;

// The address of the licences of what the page is made of.
export const notice_address = (): string => "NOTICE";
