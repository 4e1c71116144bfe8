import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { type Plugin, defineConfig } from "vite";

// Addresses are relative, because the page may be served below any path. `npm run dev` takes the data from a server at TERACELL_URL.
const server = process.env.TERACELL_URL ?? "http://127.0.0.1:8080";
// Everything but the page itself and Vite's own addresses.
const data = "^/(?!$|[?]|index\\.html|src/|node_modules/|@|__)";

// The module that reads grids without a server: the file that TERACELL_MODULE names, if it is set.
const built = process.env.TERACELL_MODULE;
const packed_module = () => gzipSync(readFileSync(built!), { level: 9 });

// "virtual:module" is where the page finds it. It is stored compressed, since many hosts would send it as it is.
const module_beside: Plugin = {
  name: "module-beside",
  resolveId: (id) => (id === "virtual:module" ? "\0module" : null),
  load(id) {
    if (id !== "\0module") return null;
    if (!built) return "export default null";
    const file = this.emitFile({ type: "asset", name: "module.bin", source: packed_module() });
    return `export default import.meta.ROLLUP_FILE_URL_${file}`;
  },
};

// What src/main.ts loads at once: the browser need not wait for that to ask for it.
const ahead: Plugin = {
  name: "ahead",
  transformIndexHtml: {
    order: "post",
    handler(_, { bundle }) {
      const app = Object.values(bundle ?? {}).find((part) => part.type === "chunk" && part.name === "app");
      if (app?.type !== "chunk") return [];
      const link = (rel: string, file: string) => ({ tag: "link", attrs: { rel, crossorigin: true, href: `./${file}` }, injectTo: "head" as const });
      return [link("modulepreload", app.fileName), ...[...app.viteMetadata!.importedCss].map((file) => link("stylesheet", file))];
    },
  },
};

// With TERACELL_WHOLE=1 the whole page becomes one file, whole.html. It opens from a disk, where a browser loads nothing else, and its policy
// forbids it to send anything.
const whole = process.env.TERACELL_WHOLE === "1";
const POLICY =
  "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval' blob:; style-src 'unsafe-inline'; img-src data: blob:; worker-src blob:; base-uri 'none'; form-action 'none'";

// What a script element may hold.
const in_script = (text: string) => text.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const element = (id: string, text: string) => `<script id="${id}" type="text/plain">${text}</script>\n`;

const inside: Plugin = {
  name: "inside",
  enforce: "pre",
  resolveId: (id) => (/\.\/(module\/)?beside$/.test(id) ? fileURLToPath(new URL("src/module/inside.ts", import.meta.url)) : null),
};
const one_file: Plugin = {
  name: "one-file",
  enforce: "post",
  generateBundle(_, bundle) {
    const parts = Object.values(bundle);
    const page = parts.find((part) => part.fileName === "index.html");
    const code = parts.flatMap((part) => (part.type === "chunk" ? [part.code] : []));
    const styles = parts.flatMap((part) => (part.type === "asset" && part.fileName.endsWith(".css") ? [String(part.source)] : []));
    if (page?.type !== "asset" || code.length !== 1 || styles.length !== 1) this.error(`expected one page, script and style sheet, found ${Object.keys(bundle)}`);
    const notice = readFileSync(new URL("../NOTICE", import.meta.url), "utf8");
    const source = String(page.source)
      .replace(/\s*<(script type="module"|link rel="stylesheet")[^>]*>(<\/script>)?/g, "")
      .replace('<meta charset="utf-8" />', () => `<meta charset="utf-8" />\n    <meta http-equiv="Content-Security-Policy" content="${POLICY}" />`)
      .replace("</head>", () => `<style>${styles[0]!}</style>\n</head>`)
      .replace(">null</script>", ">[]</script>")
      .replace("</body>", () => `${element("notice", in_script(notice))}${element("module", packed_module().toString("base64"))}<script type="module">${in_script(code[0]!.replaceAll("__VITE_PRELOAD__", "void 0"))}</script>\n</body>`);
    for (const part of parts) delete bundle[part.fileName];
    this.emitFile({ type: "asset", fileName: "whole.html", source });
  },
};

const out = process.env.TERACELL_WEB_OUT ?? "dist";
export default defineConfig({
  plugins: [module_beside, ahead, ...(whole ? [inside, one_file] : [])],
  worker: { format: whole ? "iife" : "es" }, // in a page from a disk, Chromium starts no worker that is a module
  base: "./",
  // three.js, which is loaded when the overview is first shown, is one piece of 600 kB.
  build: {
    chunkSizeWarningLimit: whole ? 1024 : 640,
    target: "es2022",
    outDir: out,
    emptyOutDir: !whole,
    assetsInlineLimit: whole ? 1 << 20 : 2048,
    cssCodeSplit: !whole,
    modulePreload: whole ? false : { polyfill: false },
    rollupOptions: { output: { inlineDynamicImports: whole } },
  },
  server: { proxy: { [data]: server } },
});
