// Where the page finds what is not loaded with it: in files beside it. Where the whole page is one file, inside.ts takes the place of this
// (vite.config.ts).
import module_address from "virtual:module";

// Whether the page was built with the module that reads grids (web/module).
export const has_module = module_address !== null;

// The module, compressed with gzip, or its address.
export function module_code(): string | Uint8Array<ArrayBuffer> {
  if (module_address === null) throw new Error("this page was built without the module that reads grids");
  return module_address;
}

export const make_worker = (): Worker => new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });

// The page as one HTML file, in which grids can be put (held.ts); null: there is none.
export const whole_page = has_module
  ? async () => {
      const response = await fetch("whole.html");
      if (!response.ok) throw new Error(`whole.html can't be loaded: ${response.status} ${response.statusText}`.trim());
      return response.text();
    }
  : null;

// The address of the licences of what the page is made of.
export const notice_address = (): string => "NOTICE";
