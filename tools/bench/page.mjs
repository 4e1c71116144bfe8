// What tools/bench/page.py measures. Usage: page.mjs PAGE SERVED FAR_PAGE FAR_SERVED [ONE_FILE], which are addresses: of a page from a plain
// host and of the same grid from its server, here and over a slow line, and of the page as one HTML file.
//
// "Sharp" is the frame in which all three slices show the whole grid, each cell in its place, counted from the beginning of navigation, with
// nothing in any cache. Memory is the proportional set size of the page's own process, which holds its workers, too.
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { launch_options } from "../../tests/support/chromium.mjs";

const { chromium } = createRequire(new URL("../../web/package.json", import.meta.url))("playwright-core");
const [here, served, far, far_served, whole] = process.argv.slice(2);
const RUNS = 9;
const WHEELS = 40;
const SWEPT = 300;
const row = (what, found, bar = "") => console.log(`${what.padEnd(72)} ${found.padEnd(58)} ${bar}`);
const sorted = (list) => [...list].sort((a, b) => a - b);
const median = (list) => sorted(list)[Math.floor(list.length / 2)];
const spread = (list, unit = "ms") => `${median(list).toFixed(0)} ${unit} (${sorted(list)[0].toFixed(0)} to ${sorted(list).at(-1).toFixed(0)})`;
const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

const browser = await chromium.launch({ ...launch_options, executablePath: "/usr/bin/chromium" });

function watch() {
  const frame = () => {
    const t = window.teracell;
    if (t && [0, 1, 2].every((axis) => t.shown(axis)?.sharp)) window.sharp_at = performance.now();
    else requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}
async function opened(address) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 } });
  const page = await context.newPage();
  await page.addInitScript(watch);
  await pause(1500); // Chromium has work of its own after a page was made or closed
  await page.goto(address, { waitUntil: "commit" });
  await page.waitForFunction(() => window.sharp_at, null, { polling: 250, timeout: 120_000 });
  return page;
}
async function sharp(address) {
  const page = await opened(address);
  const at = await page.evaluate(() => window.sharp_at);
  await page.context().close();
  await pause(1500);
  return at;
}
async function in_turn(what, ours, theirs, bar) {
  const [a, b] = [[], []];
  for (let i = 0; i < RUNS; ++i) {
    a.push(await sharp(ours));
    b.push(await sharp(theirs));
  }
  row(what, spread(a), bar);
  row("  the page of `teracell serve`, in turn; ratio", `${spread(b)}; ${median(a.map((t, i) => t / b[i])).toFixed(2)}`);
}

// The largest renderer, in MB.
function memory() {
  const sizes = [0];
  for (const process of readdirSync("/proc"))
    try {
      if (!/^\d+$/.test(process) || !readFileSync(`/proc/${process}/cmdline`, "utf8").includes("--type=renderer")) continue;
      sizes.push(Number(/^Pss:\s*(\d+)/m.exec(readFileSync(`/proc/${process}/smaps_rollup`, "utf8"))[1]) / 1000);
    } catch {
      // It has ended.
    }
  return Math.max(...sizes);
}

// The times from a turn of the wheel to a sharp slice, from slices that were not asked for before.
async function wheels(page) {
  const box = await page.locator('[data-view="z"] .view-body').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  const found = [];
  for (let i = 0; i < WHEELS; ++i) {
    await page.evaluate((share) => teracell.viewer.set_slice(2, Math.floor(teracell.viewer.cells[2] * share)), 0.25 + 0.5 * ((i * 0.6180339887) % 1));
    await page.waitForFunction(() => teracell.idle(), null, { polling: "raf" });
    await page.evaluate(() => {
      window.turned = new Promise((done) =>
        addEventListener(
          "wheel",
          ({ timeStamp }) => {
            const frame = () => setTimeout(() => (teracell.shown(2).sharp ? done(performance.now() - timeStamp) : requestAnimationFrame(frame)));
            requestAnimationFrame(frame);
          },
          { capture: true, passive: true, once: true },
        ),
      );
    });
    await page.mouse.wheel(0, 100);
    found.push(await page.evaluate(() => window.turned));
  }
  return found;
}

// The view across z alone, with cells of level 0 that are 1.5 pixels wide, at a change of material: every step needs new tiles.
async function close_up(page) {
  await page.evaluate(() => {
    const { viewer } = teracell;
    viewer.layout.value = "z";
    viewer.zoom.value = 1.5 / (viewer.axes[0].plane(1) - viewer.axes[0].plane(0));
  });
  await page.waitForFunction(() => teracell.idle(), null, { polling: "raf" });
}

try {
  await in_turn("first whole view from a plain host", here, served, "<= 1000 ms");
  await in_turn("  at 20 Mbit/s and 80 ms", far, far_served, "<= 3000 ms");
  {
    const page = await opened(here);
    await pause(4000);
    row("wheel to a sharp slice, the whole grid", spread(await wheels(page)), "median <= 150 ms");
    await close_up(page);
    row("  single cells", spread(await wheels(page)), "median <= 150 ms");
    await page.context().close();
  }
  {
    const page = await opened(here);
    const sizes = [];
    for (let i = 0; i <= SWEPT; ++i) {
      await page.evaluate((share) => teracell.viewer.set_slice(2, Math.floor(teracell.viewer.cells[2] * share)), 0.1 + (0.8 * i) / SWEPT);
      await page.waitForFunction(() => teracell.idle(), null, { polling: "raf" });
      if (i % 50 === 0) sizes.push((await pause(2000), memory()));
    }
    row(`memory every 50 of ${SWEPT} slices`, `${sizes.map((s) => s.toFixed(0)).join(", ")} MB`, "flat");
    await page.context().close();
  }
  if (whole) {
    const times = [];
    for (let i = 0; i < 5; ++i) times.push(await sharp(whole));
    row("one HTML file, from a disk", spread(times), "<= 2000 ms");
    const page = await opened(whole);
    await pause(4000);
    row("  memory", `${memory().toFixed(0)} MB`, "<= 400 MB");
    row("  wheel to a sharp slice", spread(await wheels(page)));
    await page.context().close();
  }
} finally {
  await browser.close();
}
