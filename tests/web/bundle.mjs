// Bundles the unit tests, with the parts of the page that they test, for Node. Usage: bundle.mjs FOLDER
// Node's runner starts a process for each file in FOLDER, which takes longer than most tests. So there is one file, together.mjs, that imports all
// tests, each in a bundle and with modules of its own; but tests that replace something of globalThis have files, and so processes, of their own.
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const web = join(here, "../../web");
const { build } = createRequire(join(web, "package.json"))("esbuild"); // Vite's own

const folder = process.argv[2];
const tests = readdirSync(join(here, "unit")).filter((name) => name.endsWith(".test.ts"));
const alone = (name) => readFileSync(join(here, "unit", name), "utf8").includes("globalThis");
const bundled = (name) => `${alone(name) ? "" : "shared/"}${name.slice(0, -".ts".length)}`;

await build({
  entryPoints: tests.map((name) => ({ in: join(here, "unit", name), out: bundled(name) })),
  outdir: folder,
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

const together = tests.filter((name) => !alone(name)).map((name) => `import "./${bundled(name)}.mjs";\n`);
writeFileSync(join(folder, "together.mjs"), together.join(""));
