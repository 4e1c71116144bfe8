// What `tools/bench web` measures, in Chromium with software rendering. Usage: bench_web.mjs URL; prints a row a line, as JSON:
// what, found, bar. The page is used by its own gestures: real wheel events over the view across z, in a window of 1400 x 900.
import { createRequire } from "node:module";
import { launch_options } from "../tests/support/chromium.mjs";

const { chromium } = createRequire(new URL("../web/package.json", import.meta.url))("playwright-core");
const url = process.argv[2];
const window_size = { width: 1400, height: 900 };
const row = (...columns) => console.log(JSON.stringify(columns));
const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];
const share = (list, part) => [...list].sort((a, b) => a - b)[Math.min(list.length - 1, Math.floor(list.length * part))];
const ms = (value) => `${value.toFixed(0)} ms`;

// In the page: follows one slice change from its wheel event on. Each frame the picture of the view is looked at: how many of its
// pixels are of a body (not the ground's colour), and of which slice it is.
function install() {
  const ground = (data) => data[0]; // of the corner: outside of every body
  const pixels = () => {
    const canvas = document.querySelector('[data-view="z"] .view-cells');
    return new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer);
  };
  const bodies = () => {
    const data = pixels();
    const nothing = ground(data);
    return data.reduce((n, pixel) => n + (pixel !== nothing ? 1 : 0), 0);
  };
  window.bench = {
    bodies,
    // Promise of { sharp, right, fewest }: milliseconds from the next wheel event to the frame in which the view is sharp, and to the
    // one in which it shows nothing of another slice; the fewest pixels of bodies in any frame between.
    next_slice: (look_at_pixels) =>
      new Promise((done) => {
        addEventListener(
          "wheel",
          (event) => {
            const began = event.timeStamp;
            const found = { right: null, fewest: Number.POSITIVE_INFINITY };
            const frame = () => {
              // A task after the frame's callbacks: the picture is that of this frame.
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
      }),
  };
}

const idle = (page) => page.waitForFunction(() => window.teracell?.idle() === true, null, { polling: "raf" });

async function open(browser, address = url) {
  const page = await browser.newPage({ viewport: window_size });
  await page.addInitScript(install);
  await page.goto(address);
  await idle(page);
  const box = await page.locator('[data-view="z"] .view-body').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  return page;
}

async function step(page, key, pixels = false) {
  if (key) await page.keyboard.down(key);
  const measured = page.evaluate((look) => bench.next_slice(look), pixels);
  await page.mouse.wheel(0, 100);
  const found = await measured;
  if (key) await page.keyboard.up(key);
  return found;
}

async function go(page, slice) {
  await page.evaluate((k) => teracell.viewer.set_slice(2, k), slice);
  await idle(page);
}

// Slices from all over the grid, steps of one and of ten.
async function steps(page, count, pixels = false) {
  const depth = await page.evaluate(() => teracell.viewer.cells[2]);
  const results = { one: [], ten: [] };
  for (let i = 0; i < count; ++i) {
    await go(page, Math.floor(depth * (0.1 + (0.8 * ((i * 7) % count)) / count)));
    const before = pixels ? await page.evaluate(() => bench.bodies()) : 0;
    for (const [name, key] of [["one", null], ["ten", "Shift"]]) {
      const found = await step(page, key, pixels);
      if (pixels) found.kept = found.fewest / Math.max(1, Math.min(before, await page.evaluate(() => bench.bodies())));
      results[name].push(found);
    }
  }
  return results;
}

const tile_requests = async () => {
  const text = await (await fetch(new URL("metrics", url))).text();
  return [...text.matchAll(/^teracell_requests_total\{route="tile_bin".*\} (\d+)$/gm)].reduce((n, m) => n + Number(m[1]), 0);
};

const browser = await chromium.launch(launch_options);
try {
  // The first load, with nothing in the cache: what of it is the page's own files.
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
    const three = (path) => own(path) && /overview/.test(path);
    row("first load, compressed, without the 3D part", `${(sum((p) => own(p) && !three(p)) / 1000).toFixed(0)} kB; 3D, later: ${(sum(three) / 1000).toFixed(0)} kB`, "<= 300 kB");
    row("  until everything is sharp, loopback", `${seconds.toFixed(2)} s`);
    await context.close();
  }

  const page = await open(browser);
  const near = await steps(page, 25);
  row("wheel event to a sharp slice, 1400 x 900: the next slice, median (95 of 100)", `${ms(median(near.one.map((f) => f.sharp)))} (${ms(share(near.one.map((f) => f.sharp), 0.95))})`, "<= 100 ms");
  row("  ten slices on (shift)", `${ms(median(near.ten.map((f) => f.sharp)))} (${ms(share(near.ten.map((f) => f.sharp), 0.95))})`, "<= 100 ms");
  const looked = await steps(page, 10, true);
  const kept = Math.min(...[...looked.one, ...looked.ten].map((f) => f.kept));
  row("  fewest pixels of the body in any frame between, of those in both slices", `${(100 * kept).toFixed(1)} %`, "nothing blank");

  const cdp = await page.context().newCDPSession(page);
  // Memory and frames of a long sweep.
  await cdp.send("Performance.enable");
  const heap = async () => {
    await cdp.send("HeapProfiler.collectGarbage");
    const { metrics } = await cdp.send("Performance.getMetrics");
    return metrics.find((m) => m.name === "JSHeapUsedSize").value / 1e6;
  };
  await go(page, 2000);
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

  // The same slice again: in the page, and by a page loaded anew.
  await go(page, 6000);
  await new Promise((done) => setTimeout(done, 500));
  await go(page, 6400);
  await new Promise((done) => setTimeout(done, 500));
  let asked = await tile_requests();
  await go(page, 6000);
  const again = (await tile_requests()) - asked;
  await new Promise((done) => setTimeout(done, 1000));
  asked = await tile_requests();
  await page.reload();
  await idle(page);
  row("requests when the same slice is shown again; by a page loaded anew", `${again}; ${(await tile_requests()) - asked}`, "none");

  // A slow link.
  await cdp.send("Network.enable");
  await cdp.send("Network.emulateNetworkConditions", { offline: false, latency: 80, downloadThroughput: 20e6 / 8, uploadThroughput: 20e6 / 8 });
  const box = await page.locator('[data-view="z"] .view-body').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  const far = await steps(page, 15);
  for (const [name, what] of [["one", "at 20 Mbit/s and 80 ms: the next slice, something right; sharp (medians)"], ["ten", "  ten slices on (shift)"]])
    row(what, `${ms(median(far[name].map((f) => f.right)))}; ${ms(median(far[name].map((f) => f.sharp)))} (at most ${ms(Math.max(...far[name].map((f) => f.sharp)))})`, "<= 300 ms; <= 1.5 s");
} finally {
  await browser.close();
}
