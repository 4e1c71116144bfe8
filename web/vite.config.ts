import { defineConfig } from "vite";

// Addresses are relative, because the page may be served below any path. `npm run dev` takes the data from a server at TERACELL_URL.
const server = process.env.TERACELL_URL ?? "http://127.0.0.1:8080";
// Everything but the page itself and Vite's own addresses.
const data = "^/(?!$|[?]|index\\.html|src/|node_modules/|@|__)";

export default defineConfig({
  base: "./",
  // three.js, which is loaded when the overview is first shown, is one piece of 600 kB.
  build: { chunkSizeWarningLimit: 640, target: "es2022", outDir: process.env.TERACELL_WEB_OUT ?? "dist", emptyOutDir: true, assetsInlineLimit: 2048 },
  server: { proxy: { [data]: server } },
});
