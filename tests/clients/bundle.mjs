// Bundles Neuroglancer for the browser with only what the test needs: segmentation layers, precomputed and Zarr sources, HTTP.
// Usage: bundle.mjs FOLDER
import { build } from "esbuild";
import { dirname } from "node:path";
import { fileURLToPath } from "node:url";

// Neuroglancer's icons are in a package that npm would fetch from GitHub. The test needs no icons.
const blank_icons = {
  name: "blank icons",
  setup(bundler) {
    bundler.onResolve({ filter: /^ikonate\// }, () => ({ path: "icon", namespace: "icon" }));
    bundler.onLoad({ filter: /.*/, namespace: "icon" }, () => ({ contents: "<svg/>", loader: "text" }));
  },
};
// With ?raw Vite imports a file as text.
const raw_text = {
  name: "raw text",
  setup(bundler) {
    bundler.onResolve({ filter: /^\..*\?raw$/ }, (args) => bundler.resolve(args.path.slice(0, -4), { kind: args.kind, resolveDir: args.resolveDir }));
  },
};

await build({
  absWorkingDir: dirname(fileURLToPath(import.meta.url)),
  // The page looks for its workers at these places, relative to itself.
  entryPoints: {
    "neuroglancer/page": "neuroglancer_page.mjs",
    "neuroglancer/chunk_worker.bundle": "neuroglancer/unstable/chunk_worker.bundle.js",
    "async_computation.bundle": "neuroglancer/unstable/async_computation.bundle.js",
  },
  outdir: process.argv[2],
  bundle: true,
  minify: true,
  format: "esm",
  plugins: [blank_icons, raw_text],
  loader: { ".svg": "text", ".wasm": "file", ".html": "file", ".png": "dataurl" },
  conditions: [
    "neuroglancer/datasource:none_by_default", "neuroglancer/datasource/precomputed:enabled", "neuroglancer/datasource/zarr:enabled",
    "neuroglancer/kvstore:none_by_default", "neuroglancer/kvstore/http:enabled", "neuroglancer/kvstore/gzip:enabled",
    "neuroglancer/layer:none_by_default", "neuroglancer/layer/segmentation:enabled",
  ],
  logLevel: "warning",
});
