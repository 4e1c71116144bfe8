// Bundles the unit tests, with the parts of the page that they test, for Node. Usage: bundle.mjs FOLDER
import { readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const web = join(here, "../../web");
const { build } = createRequire(join(web, "package.json"))("esbuild"); // Vite's own

await build({
  entryPoints: readdirSync(join(here, "unit"))
    .filter((name) => name.endsWith(".test.ts"))
    .map((name) => join(here, "unit", name)),
  outdir: process.argv[2],
  outExtension: { ".js": ".mjs" },
  nodePaths: [join(web, "node_modules")],
  alias: {
    "@page": join(web, "src"),
    "@preact/signals": join(web, "node_modules/@preact/signals/dist/signals.mjs"), // one copy for the tests and the page
  },
  bundle: true,
  platform: "node",
  format: "esm",
  target: "node18",
  jsx: "automatic",
  jsxImportSource: "preact",
  logLevel: "warning",
});
