// What the tests in a browser share: servers, pages, and what `teracell` itself says about the same grids.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { createWriteStream, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, join } from "node:path";
import { inflateSync } from "node:zlib";
import { after } from "node:test";
import { errors_of, launch_options } from "../support/chromium.mjs";
import { read_npy } from "../support/npy.mjs";

const { chromium } = createRequire(new URL("../../web/package.json", import.meta.url))("playwright-core");
const program = process.env.TERACELL;
export const folder = process.env.TERACELL_FOLDER;
export const grids = join(folder, "grids");
export const grid_file = (name) => join(grids, `${name}.tcell`);

// A test that fails may leave servers running. They keep nobody waiting, and they end with the run.
const children = new Set();
process.on("exit", () => children.forEach((child) => child.kill("SIGKILL")));

// Starts `teracell serve` with these arguments, on a free port unless they name one. stop() returns what was wrong: an exit status,
// answers 5xx that were not expected, and lines in the log that are not requests.
export async function serve(...args) {
  const log = join(folder, `server-${process.argv[1].match(/(\w+)_test/)?.[1] ?? "x"}-${children.size}.log`);
  const child = spawn(program, ["serve", ...args, ...(args.includes("--port") ? [] : ["--port", "0"]), "--log", "json"], {
    stdio: ["ignore", "pipe", "pipe"],
  });
  children.add(child);
  const lines = [];
  let rest = "";
  child.stderr.on("data", (data) => {
    const parts = (rest + data).split("\n");
    rest = parts.pop();
    lines.push(...parts);
  });
  child.stderr.pipe(createWriteStream(log));
  const ended = new Promise((resolve) => child.on("close", (status) => resolve(status)));
  const url = await new Promise((resolve, reject) => {
    let said = "";
    child.stdout.on("data", (data) => {
      said += data;
      const found = /http:\/\/\S+/.exec(said);
      if (found) resolve(found[0]);
    });
    void ended.then((status) => reject(new Error(`the server ended with status ${status}: ${lines.join("\n")}`)));
  });
  const parts = [child, child.stdout, child.stderr];
  for (const part of parts) part.unref();
  const wait = () => {
    for (const part of parts) part.ref();
    return ended;
  };
  return {
    url,
    port: new URL(url).port,
    // Ends the server as if its machine had gone away.
    async kill() {
      child.kill("SIGKILL");
      await wait();
    },
    async stop(expected = () => false) {
      child.kill("SIGTERM");
      const status = await wait();
      const wrong = lines.filter((line) => !expected(line) && (!line.startsWith("{") || JSON.parse(line).status >= 500));
      return status === 0 ? wrong : [...wrong, `exit status ${status}`];
    },
  };
}

// A server of all grids and a browser, for all tests of a file. Both must end well.
export async function server_and_browser() {
  const [server, browser] = await Promise.all([serve(grids), chromium.launch(launch_options)]);
  after(async () => {
    await browser.close();
    assert.deepEqual(await server.stop(), []);
  });
  return { server, browser };
}

// Opens a page of the dashboard in a window of its own. What goes wrong on it is collected in `page.errors`.
export async function open_page(browser, url, options = {}) {
  const { width = 1400, height = 900, expected, context: given, ...rest } = options;
  const context = given ?? (await browser.newContext({ viewport: { width, height }, ...rest }));
  const page = await context.newPage();
  page.errors = errors_of(page, new URL(url).origin, expected);
  page.setDefaultTimeout(60_000);
  await page.goto(url);
  return page;
}

// Closes a page, on which nothing may have gone wrong.
export async function close(page) {
  assert.deepEqual(page.errors, []);
  await page.context().close();
}

export async function open_grid(browser, url, options) {
  const page = await open_page(browser, url, options);
  await settled(page);
  return page;
}

// Waits until everything in sight is sharp, painted, and on the screen.
export async function settled(page) {
  await page.waitForFunction(() => window.teracell?.idle() === true, null, { polling: "raf" });
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

// A part of the viewer's state by its name: cell, centre, zoom, layout ...
export const state = (page, name) => page.evaluate((n) => teracell.viewer[n].value, name);
export const set_state = (page, values) =>
  page.evaluate((given) => {
    for (const [name, value] of Object.entries(given)) teracell.viewer[name].value = value;
  }, values);

export const view = (page, axis) => page.locator(`[data-view="${axis}"] .view-body`);
const middle_of = (page, axis) =>
  view(page, axis).evaluate((body) => {
    const { left, top } = body.getBoundingClientRect();
    return [left + body.clientWidth / 2, top + body.clientHeight / 2];
  });
// A point of a view at about this distance from its middle, in whole CSS pixels of the page: wheel events know no fractions.
export async function point_of(page, axis, dx = 0, dy = 0) {
  const [x, y] = await middle_of(page, axis);
  return [Math.round(x + dx), Math.round(y + dy)];
}
// The exact distance of a point of the page from the middle of a view.
export async function offset_in(page, axis, [x, y]) {
  const middle = await middle_of(page, axis);
  return [x - middle[0], y - middle[1]];
}
// Waits until no request for tiles is under way or waiting.
export const quiet = (page) => page.waitForFunction(() => teracell.viewer.tiles.in_flight.value + teracell.viewer.tiles.waiting.value === 0);

// The pixels of a view's cells, without what is drawn over them: { width, height, data }, with a number per pixel (little-endian RGBA).
export async function pixels(page, axis) {
  const found = await page.evaluate((name) => {
    const canvas = document.querySelector(`[data-view="${name}"] .view-cells`);
    const { width, height } = canvas;
    const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
    let text = "";
    for (let i = 0; i < data.length; i += 8192) text += String.fromCharCode(...data.subarray(i, i + 8192));
    return { width, height, text: btoa(text) };
  }, axis);
  const bytes = Buffer.from(found.text, "base64");
  return { width: found.width, height: found.height, data: new Uint32Array(new Uint8Array(bytes).buffer) };
}

export function shares(data) {
  const counts = new Map();
  for (const pixel of data) counts.set(pixel, (counts.get(pixel) ?? 0) + 1);
  return new Map([...counts].map(([pixel, count]) => [pixel, count / data.length]));
}

export const packed = (r, g, b) => (0xff000000 | (b << 16) | (g << 8) | r) >>> 0;

// Takes a screenshot, which stays as build/web/NAME.png. Returns its pixels as RGB.
export async function screenshot(page, name) {
  return decoded_png(await page.screenshot({ path: join(folder, `${name}.png`) }));
}

// Decodes a PNG of Chromium: 8 bits per channel, not interlaced.
export function decoded_png(file) {
  const [width, height, depth, color] = [file.readUInt32BE(16), file.readUInt32BE(20), file[24], file[25]];
  const channels = { 2: 3, 6: 4 }[color];
  if (depth !== 8 || !channels) throw new Error(`a PNG of color type ${color}, ${depth} bits`);
  const parts = [];
  for (let at = 8; at < file.length; at += 12 + file.readUInt32BE(at))
    if (file.toString("latin1", at + 4, at + 8) === "IDAT") parts.push(file.subarray(at + 8, at + 8 + file.readUInt32BE(at)));
  const raw = inflateSync(Buffer.concat(parts));
  const stride = width * channels;
  const rows = Buffer.alloc(stride * height);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (stride + 1)];
    for (let x = 0; x < stride; ++x) {
      const a = x >= channels ? rows[y * stride + x - channels] : 0;
      const b = y > 0 ? rows[(y - 1) * stride + x] : 0;
      const c = x >= channels && y > 0 ? rows[(y - 1) * stride + x - channels] : 0;
      const p = a + b - c;
      const [pa, pb, pc] = [Math.abs(p - a), Math.abs(p - b), Math.abs(p - c)];
      const guess = [0, a, b, (a + b) >> 1, pa <= pb && pa <= pc ? a : pb <= pc ? b : c][filter];
      rows[y * stride + x] = raw[y * (stride + 1) + 1 + x] + guess;
    }
  }
  const data = new Uint32Array(width * height);
  for (let i = 0; i < data.length; ++i) data[i] = packed(rows[i * channels], rows[i * channels + 1], rows[i * channels + 2]);
  return { width, height, data };
}

const told = (...args) => JSON.parse(execFileSync(program, [...args, "--json"], { maxBuffer: 1 << 28 }));
export const info_of = (name) => told("info", grid_file(name));
export const column_of = (name, axis, at) => told("column", grid_file(name), "--axis", axis, "--at", at.join(","));
export const stats_of = (name, region) => told("stats", grid_file(name), ...(region ? ["--region", region.join(",")] : []));

// Material ids of a slice, rows of v from 0: { shape: [nv, nu], data }.
export function slice_of(name, axis, index) {
  const path = join(folder, `${basename(name)}-${axis}-${index}.npy`);
  execFileSync(program, ["slice", grid_file(name), "--axis", axis, "--index", String(index), "-o", path], { stdio: "ignore" });
  return read_npy(path);
}

// The leaves that a slice meets, by `teracell export`: { level, cell } each.
export function leaves_of_slice(name, axis, index, refine, want) {
  const [lo, hi] = [[0, 0, 0], [...info_of(name).grid.cells]];
  [lo["xyz".indexOf(axis)], hi["xyz".indexOf(axis)]] = [index, index + 1];
  const path = join(folder, `${basename(name)}-leaves.npy`);
  const region = ["--region", [...lo, ...hi].join(",")];
  execFileSync(program, ["export", grid_file(name), "--format", "leaves", "--refine", refine, "--want", want, ...region, "-o", path], { stdio: "ignore" });
  const file = readFileSync(path);
  const records = file.subarray(10 + file.readUInt16LE(8));
  return Array.from({ length: records.length / 32 }, (_, n) => ({
    level: records.readInt32LE(32 * n),
    cell: [4, 12, 20].map((at) => Number(records.readBigInt64LE(32 * n + at))),
  }));
}
export const leaf_count_of = (name, refine, want) => told("export", grid_file(name), "--refine", refine, "--want", want, "--count");

// The material of one cell, by `teracell export`.
export function exported_cell(name, [i, j, k]) {
  const path = join(folder, "cell.npy");
  execFileSync(program, ["export", grid_file(name), "-o", path, "--region", [i, j, k, i + 1, j + 1, k + 1].join(",")], { stdio: "ignore" });
  return read_npy(path).data[0];
}

// The cell that each column and each row of pixels of a view must show, according to where the page says that it looks; -1 outside the grid.
export function cells_of_pixels(name, axis, { centre, zoom }, width, height) {
  const info = info_of(name);
  const [u, v] = [[1, 2], [0, 2], [0, 1]]["xyz".indexOf(axis)];
  const plane = (d, i) => {
    const a = info.grid.axes[d];
    return a.type === "graded" ? a.planes[i] : a.min + (a.first + i) * a.step;
  };
  const cells_along = (d, count, coordinate) => {
    const n = info.grid.cells[d];
    return Array.from({ length: count }, (_, pixel) => {
      const x = coordinate(pixel + 0.5);
      if (x < plane(d, 0) || x >= plane(d, n)) return -1;
      let [low, high] = [0, n];
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (x < plane(d, middle)) high = middle;
        else low = middle;
      }
      return low;
    });
  };
  return {
    columns: cells_along(u, width, (x) => centre[u] + (x - width / 2) / zoom),
    rows: cells_along(v, height, (y) => centre[v] - (y - height / 2) / zoom),
  };
}

// The material that each pixel of a view must show; -1 outside the grid.
export function expected_labels(name, axis, looks, width, height) {
  const { columns, rows } = cells_of_pixels(name, axis, looks, width, height);
  const { shape, data } = slice_of(name, axis, looks.cell["xyz".indexOf(axis)]);
  return Int32Array.from({ length: width * height }, (_, i) => {
    const [a, b] = [columns[i % width], rows[Math.floor(i / width)]];
    return a < 0 || b < 0 ? -1 : data[b * shape[1] + a];
  });
}
