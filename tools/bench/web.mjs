// What `tools/bench/run web` measures, in Chromium with software rendering. Usage: web.mjs URL; prints one row per line, as
// JSON: what, found, bar. The page gets real wheel events over the view across z, in a window of 1400 x 900.
import { createRequire } from "node:module";
import { launch_options } from "../../tests/support/chromium.mjs";

const { chromium } = createRequire(new URL("../../web/package.json", import.meta.url))("playwright-core");
const url = process.argv[2];
const window_size = { width: 1400, height: 900 };
const row = (...columns) => console.log(JSON.stringify(columns));
const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];
const share = (list, part) => [...list].sort((a, b) => a - b)[Math.min(list.length - 1, Math.floor(list.length * part))];
const ms = (value) => `${value.toFixed(0)} ms`;

// In the page: follows one change of slice, beginning with its wheel event. For each frame it finds how many pixels of the view have
// the body's colour, and whether the view still shows parts of another slice.
function install() {
  const pixels = () => {
    const canvas = document.querySelector('[data-view="z"] .view-cells');
    return new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer);
  };
  const bodies = () => {
    const [r, g, b] = teracell.viewer.looks.value[1].color;
    const body = (0xff000000 | (b << 16) | (g << 8) | r) >>> 0;
    return pixels().reduce((n, pixel) => n + (pixel === body ? 1 : 0), 0);
  };
  window.bench = {
    bodies,
    // Makes `found` a promise of { sharp, right, fewest }. `sharp` and `right` are the milliseconds from the next wheel event to the
    // frame in which the view is sharp, and to the one in which it shows nothing of another slice. `fewest` is the smallest number
    // of the body's pixels in any frame until then.
    found: null,
    watch(look_at_pixels) {
      this.found = new Promise((done) => {
        addEventListener(
          "wheel",
          (event) => {
            const began = event.timeStamp;
            const found = { right: null, fewest: Number.POSITIVE_INFINITY };
            const frame = () => {
              // This task runs after the frame's callbacks, so the picture is that of this frame.
              setTimeout(() => {
                const now = performance.now();
                const state = teracell.shown(2);
                if (look_at_pixels) found.fewest = Math.min(found.fewest, bodies());
                if (!state.stale) found.right ??= now - began;
                if (state.sharp) done({ ...found, sharp: now - began });
                else requestAnimationFrame(frame);
              });
            };
            requestAnimationFrame(frame);
          },
          { capture: true, passive: true, once: true },
        );
      });
    },
  };
}

const idle = (page) => page.waitForFunction(() => window.teracell?.idle() === true, null, { polling: "raf" });

async function open(browser, address = url) {
  const page = await browser.newPage({ viewport: window_size });
  await page.addInitScript(install);
  await page.goto(address);
  await idle(page);
  await over_z(page);
  return page;
}

async function over_z(page) {
  const box = await page.locator('[data-view="z"] .view-body').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
}

async function step(page, key, pixels = false) {
  if (key) await page.keyboard.down(key);
  await page.evaluate((look) => bench.watch(look), pixels);
  await page.mouse.wheel(0, 100);
  const found = await page.evaluate(() => bench.found);
  if (key) await page.keyboard.up(key);
  return found;
}

async function go(page, slice) {
  await page.evaluate((k) => teracell.viewer.set_slice(2, k), slice);
  await idle(page);
}

// Steps of one slice and of ten, from slices in the middle half of the grid that were not asked for before.
let visited = 0;
async function steps(page, count, pixels = false) {
  const depth = await page.evaluate(() => teracell.viewer.cells[2]);
  const results = { one: [], ten: [] };
  for (let i = 0; i < count; ++i) {
    await go(page, Math.floor(depth * (0.25 + 0.5 * ((++visited * 0.6180339887) % 1))));
    const before = pixels ? await page.evaluate(() => bench.bodies()) : 0;
    for (const [name, key] of [["one", null], ["ten", "Shift"]]) {
      const found = await step(page, key, pixels);
      const least = pixels ? Math.min(before, await page.evaluate(() => bench.bodies())) : 0;
      found.kept = least > 1000 ? found.fewest / least : 1; // with fewer pixels there is nothing to lose
      results[name].push(found);
    }
  }
  return results;
}

// Shows the view across z alone, at the first change of material along x, with cells of level 0 that are 1.5 pixels wide. So every
// step needs new tiles. A view of a whole grid of 10^12 cells takes them from a level whose slices are 16 cells thick.
async function close_up(page) {
  await page.evaluate(async () => {
    const { viewer } = teracell;
    const [i, j, k] = viewer.cells.map((n) => Math.floor(n / 2));
    const { runs } = await (await fetch(viewer.address.column(0, j, k))).json();
    viewer.layout.value = "z";
    viewer.go_to_cell([runs.length > 1 ? runs[0].to : i, j, k]);
    viewer.zoom.value = 1.5 / (viewer.axes[0].plane(1) - viewer.axes[0].plane(0));
  });
  await idle(page);
  await over_z(page);
}

// Returns a function that counts the tiles that came over the network more than once.
function watch_tiles(cdp) {
  const flights = new Map();
  const fetched = new Map();
  cdp.on("Network.responseReceived", ({ requestId, response }) => !response.fromDiskCache && /\/tile\//.test(response.url) && flights.set(requestId, response.url));
  cdp.on("Network.requestServedFromCache", ({ requestId }) => flights.delete(requestId));
  cdp.on("Network.loadingFinished", ({ requestId }) => {
    const address = flights.get(requestId);
    if (address) fetched.set(address, (fetched.get(address) ?? 0) + 1);
  });
  return () => [...fetched.values()].filter((n) => n > 1).length;
}

const browser = await chromium.launch({ ...launch_options, executablePath: "/usr/bin/chromium" });
try {
  // The first load, with nothing in the cache: the bytes of the page's own files.
  {
    const context = await browser.newContext({ viewport: window_size });
    const page = await context.newPage();
    const cdp = await context.newCDPSession(page);
    await cdp.send("Network.enable");
    const files = new Map();
    cdp.on("Network.responseReceived", ({ requestId, response }) => files.set(requestId, { path: new URL(response.url).pathname, bytes: 0 }));
    cdp.on("Network.loadingFinished", ({ requestId, encodedDataLength }) => files.has(requestId) && (files.get(requestId).bytes = encodedDataLength));
    const began = performance.now();
    await page.goto(url);
    await idle(page);
    const seconds = (performance.now() - began) / 1000;
    await page.waitForLoadState("networkidle");
    const sum = (test) => [...files.values()].filter(({ path }) => test(path)).reduce((n, { bytes }) => n + bytes, 0);
    const own = (path) => path.endsWith("/") || path.includes("/assets/") || path.endsWith(".svg");
    const three = (path) => own(path) && /overview|viewpoint/.test(path);
    row("first load, compressed, without the 3D part", `${(sum((p) => own(p) && !three(p)) / 1000).toFixed(0)} kB; 3D, later: ${(sum(three) / 1000).toFixed(0)} kB`, "<= 300 kB");
    row("  until everything is sharp, loopback", `${seconds.toFixed(2)} s`);
    await context.close();
  }

  const page = await open(browser);
  const cdp = await page.context().newCDPSession(page);
  await cdp.send("Network.enable");
  const twice = watch_tiles(cdp);
  const sharp = (list) => `${ms(median(list.map((f) => f.sharp)))} (${ms(share(list.map((f) => f.sharp), 0.95))})`;
  const kept = [];
  for (const [what, prepare] of [["the whole grid", async () => {}], ["single cells", close_up]]) {
    await prepare(page);
    const near = await steps(page, 25);
    row(`wheel event to a sharp slice, 1400 x 900, ${what}: median (95 of 100)`, sharp(near.one), "<= 100 ms");
    row("  ten slices on (shift)", sharp(near.ten), "<= 100 ms");
    const looked = await steps(page, 10, true);
    kept.push(...[...looked.one, ...looked.ten].map((f) => f.kept));
  }
  row("  fewest pixels of the body in any frame between, of those in both slices", `${(100 * Math.min(...kept)).toFixed(1)} %`, "nothing blank");

  // Memory and frames of a long sweep.
  await cdp.send("Performance.enable");
  const heap = async () => {
    await cdp.send("HeapProfiler.collectGarbage");
    const { metrics } = await cdp.send("Performance.getMetrics");
    return metrics.find((m) => m.name === "JSHeapUsedSize").value / 1e6;
  };
  await page.evaluate(() => {
    teracell.viewer.layout.value = "four";
    teracell.viewer.zoom.value = 0;
  });
  await go(page, 2000);
  await over_z(page);
  await new Promise((done) => setTimeout(done, 3000)); // the overview, hidden until now, is drawn anew
  const heaps = [await heap()];
  const frames = [];
  for (let part = 0; part < 3; ++part) {
    await page.evaluate(() => (teracell.frame_times.length = 0));
    for (let i = 0; i < 100; ++i) {
      await page.mouse.wheel(0, 100);
      await new Promise((done) => setTimeout(done, 25));
    }
    frames.push(...(await page.evaluate(() => [...teracell.frame_times])));
    await idle(page);
    heaps.push(await heap());
  }
  row("300 slices swept by wheel: frame time, median and 95 of 100", `${median(frames).toFixed(1)} ms, ${share(frames, 0.95).toFixed(1)} ms (${frames.length} frames)`, "p95 <= 33 ms");
  row("  JavaScript heap before, after 100, 200, 300 slices", `${heaps.map((h) => h.toFixed(1)).join(", ")} MB`, "flat");

  // The same slices again, in the page and after it was reloaded.
  for (const slice of [6000, 6400, 6000]) {
    await go(page, slice);
    await new Promise((done) => setTimeout(done, 1500));
  }
  await page.reload();
  await idle(page);
  row("tiles fetched a second time, by the page and after a reload", String(twice()), "none");

  await cdp.send("Network.emulateNetworkConditions", { offline: false, latency: 80, downloadThroughput: 20e6 / 8, uploadThroughput: 20e6 / 8 });
  for (const [what, prepare] of [["the whole grid", over_z], ["single cells", close_up]]) {
    await prepare(page);
    const far = await steps(page, 15);
    const times = (list) => `${ms(median(list.map((f) => f.right)))}; ${ms(median(list.map((f) => f.sharp)))} (at most ${ms(Math.max(...list.map((f) => f.sharp)))})`;
    row(`at 20 Mbit/s and 80 ms, ${what}: something right; sharp (medians)`, times(far.one), "<= 300 ms; <= 1.5 s");
    row("  ten slices on (shift)", times(far.ten), "<= 300 ms; <= 1.5 s");
  }
} finally {
  await browser.close();
}
