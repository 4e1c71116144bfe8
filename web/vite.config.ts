import { readFileSync } from "node:fs";
import { type Plugin, defineConfig } from "vite";

// Addresses are relative, because the page may be served below any path. `npm run dev` takes the data from a server at TERACELL_URL.
const server = process.env.TERACELL_URL ?? "http://127.0.0.1:8080";
// Everything but the page itself and Vite's own addresses.
const data = "^/(?!$|[?]|index\\.html|src/|node_modules/|@|__)";

// "virtual:module" is where the page finds the module that reads grids without a server: the file that TERACELL_MODULE names, if it is set.
const built = process.env.TERACELL_MODULE;
const page_module: Plugin = {
  name: "page-module",
  resolveId: (id) => (id === "virtual:module" ? "\0module" : null),
  load(id) {
    if (id !== "\0module") return null;
    if (!built) return "export default null";
    const file = this.emitFile({ type: "asset", name: "module.wasm", source: readFileSync(built) });
    return `export default import.meta.ROLLUP_FILE_URL_${file}`;
  },
};

export default defineConfig({
  plugins: [page_module],
  worker: { format: "es" },
  base: "./",
  // three.js, which is loaded when the overview is first shown, is one piece of 600 kB.
  build: { chunkSizeWarningLimit: 640, target: "es2022", outDir: process.env.TERACELL_WEB_OUT ?? "dist", emptyOutDir: true, assetsInlineLimit: 2048 },
  server: { proxy: { [data]: server } },
});
