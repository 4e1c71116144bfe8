// What the JavaScript clients share: the server's address, results of `teracell export`, and a browser.
import { execFileSync } from "node:child_process";
import { createReadStream, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join } from "node:path";
import { chromium } from "playwright-core";
import { errors_of, launch_options } from "../support/chromium.mjs";
import { read_npy } from "../support/npy.mjs";

export const server = process.env.TERACELL_URL;
// The folder of exports, pages and screenshots.
export const folder = process.env.TERACELL_FOLDER;
export const grids = JSON.parse(readFileSync(join(folder, "grids.json")));

// The export of a level as {shape: [nz, ny, nx], data}.
export const exported = (grid, level) => read_npy(join(folder, `${grid}.${level}.npy`));

// Fails at the first difference and says where it is.
export function expect_same(found, expected, what) {
  if (found.length !== expected.length) throw new Error(`${what}: ${found.length} values, expected ${expected.length}`);
  const at = expected.findIndex((value, i) => value !== found[i]);
  if (at >= 0) throw new Error(`${what}: value ${at} is ${found[at]}, expected ${expected[at]}`);
}

const kTypes = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };
const kZarrDocument = /\/(\.zarray|\.zattrs|\.zgroup|\.zmetadata|zarr\.json)$/;

// Chromium with the pages of `folder`. Like pages of other projects, they have another origin than the cells.
export async function open_browser() {
  const pages = createServer((request, response) => {
    const file = createReadStream(join(folder, "pages", new URL(request.url, "http://pages").pathname));
    file.on("error", () => response.writeHead(404).end());
    file.on("open", () => {
      response.writeHead(200, { "content-type": kTypes[extname(file.path)] ?? "application/octet-stream" });
      file.pipe(response);
    });
  });
  await new Promise((listening) => pages.listen(0, "127.0.0.1", listening));
  const browser = await chromium.launch(launch_options);
  return {
    // A page, and in `errors` all errors of the page and all failed requests to the server. Zarr's clients look for documents of
    // both versions, so those may be missing.
    async open(path) {
      const page = await browser.newPage({ viewport: { width: 1500, height: 900 } });
      const errors = errors_of(page, server, (url, status) => status === 404 && kZarrDocument.test(url));
      await page.goto(`http://127.0.0.1:${pages.address().port}/${path}`);
      return { page, errors };
    },
    async close() {
      await browser.close();
      pages.close();
    },
  };
}

// Takes a screenshot and returns its colours, as RGBA in little endian.
export async function screenshot(page, name) {
  const png = await page.screenshot({ path: join(folder, `${name}.png`) });
  return page.evaluate(async (url) => {
    const picture = await createImageBitmap(await (await fetch(url)).blob());
    const context = new OffscreenCanvas(picture.width, picture.height).getContext("2d");
    context.drawImage(picture, 0, 0);
    return [...new Set(new Uint32Array(context.getImageData(0, 0, picture.width, picture.height).data.buffer))];
  }, `data:image/png;base64,${png.toString("base64")}`);
}

// `teracell slice` as PNG.
export function slice_picture(grid, axis, index) {
  const file = join(folder, `${grid}-${axis}-${index}.png`);
  execFileSync(process.env.TERACELL, ["slice", `${grid}.tcell`, "--axis", axis, "--index", String(index), "-o", file], { cwd: folder, stdio: "ignore" });
  return readFileSync(file);
}
