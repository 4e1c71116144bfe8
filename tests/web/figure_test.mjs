// Figures for print: the size, the density, the colours and the legend are those that were chosen, and the cells are those of the grid.
import assert from "node:assert/strict";
import test from "node:test";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { close, folder, info_of, open_page, packed, screenshot, server_and_browser, settled, slice_of } from "./support.mjs";

const { server, browser } = await server_and_browser();

async function open_dialog(hash) {
  const page = await open_page(browser, `${server.url}#${hash}`, { acceptDownloads: true });
  if (hash.includes("3d")) await page.waitForSelector('.overview[data-state="sharp"]');
  else await settled(page);
  await page.keyboard.press("f");
  await page.getByRole("dialog").waitFor();
  await page.getByRole("img", { name: "Preview of the figure" }).waitFor();
  return page;
}

async function choose(page, choices) {
  for (const [label, value] of Object.entries(choices)) {
    const field = page.getByRole("dialog").getByLabel(label, { exact: true });
    if (typeof value === "boolean") await field.setChecked(value);
    else if (await field.evaluate((e) => e.tagName === "SELECT")) await field.selectOption(value);
    else await field.fill(String(value));
  }
}

async function save(page) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save", exact: true }).click()]);
  const path = join(folder, download.suggestedFilename());
  await download.saveAs(path);
  await page.getByText(/^Saved /).waitFor();
  return { name: download.suggestedFilename(), bytes: readFileSync(path) };
}

// The chunks of a PNG.
function chunks(png) {
  const found = new Map();
  for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at)) found.set(png.toString("latin1", at + 4, at + 8), png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
  return found;
}

// The pixels of a PNG, decoded by the browser: packed RGBA.
const pixels_of = (page, png) =>
  page.evaluate(async (text) => {
    const picture = await createImageBitmap(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))]));
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const context = canvas.getContext("2d");
    context.drawImage(picture, 0, 0);
    return { width: picture.width, height: picture.height, data: [...new Uint32Array(context.getImageData(0, 0, picture.width, picture.height).data.buffer)] };
  }, png.toString("base64"));

test("a PNG without surroundings is the slice, cell by cell, in the density that was chosen", async () => {
  const { materials, grid } = info_of("open");
  const page = await open_dialog("g=open&layout=z");
  const side = 4 * grid.cells[0];
  await choose(page, { Width: side, Unit: "px", "Dots per inch": 254, Crop: "whole", "Axes with coordinates": false, "Legend of the materials that are seen": false });
  const { name, bytes } = await save(page);
  assert.match(name, /^open-z-.*m\.png$/);
  const found = chunks(bytes);
  assert.deepEqual([found.get("pHYs").readUInt32BE(0), found.get("pHYs").readUInt32BE(4), found.get("pHYs")[8]], [10000, 10000, 1]);
  const { width, height, data } = await pixels_of(page, bytes);
  assert.deepEqual([width, height], [side, side + Math.round((2 * 254) / 72)]);
  const cell = await page.evaluate(() => teracell.viewer.cell.value);
  const { shape, data: cells } = slice_of("open", "z", cell[2]);
  const color = materials.map(({ color: text }, id) => (id === 0 ? packed(255, 255, 255) : packed(...[1, 3, 5].map((at) => Number.parseInt(text.slice(at, at + 2), 16)))));
  for (let v = 0; v < shape[0]; ++v)
    for (let u = 0; u < shape[1]; ++u) assert.equal(data[(side - 4 * v - 2) * width + 4 * u + 2], color[cells[v * shape[1] + u]], `cell ${u}, ${v}`);
  await close(page);
});

test("a clear ground is clear, and the legend names what is seen and nothing else", async () => {
  const page = await open_dialog("g=stadium&at=300,240,118&layout=z");
  await choose(page, { Ground: "clear", Crop: "whole", Format: "svg", "Scale bar": true });
  await page.getByRole("button", { name: "Title from the view" }).click();
  const { name, bytes } = await save(page);
  assert.match(name, /\.svg$/);
  const svg = bytes.toString();
  const seen = new Set(slice_of("stadium", "z", 118).data);
  const texts = [...svg.matchAll(/<text[^>]*>([^<]*)<\/text>/g)].map((match) => match[1]);
  const { materials } = info_of("stadium");
  for (const { id, name: material } of materials.slice(1)) assert.equal(texts.includes(material), seen.has(id), `${material}: ${texts}`);
  assert.ok(texts.includes("x [m]") && texts.includes("y [m]"));
  assert.ok(texts[0].startsWith("stadium, z = "));
  assert.ok(!svg.includes('<rect x="0" y="0"'), "there is a ground");
  // The areas of the shapes are those of the cells.
  const sizes = new Map();
  for (const [, fill, d] of svg.matchAll(/<path fill="rgb\(([\d,]+)\)" shape-rendering[^>]* d="([^"]*)"/g))
    for (const [, x0, y0, x1, y1] of d.matchAll(/M([\d.]+) ([\d.]+)H([\d.]+)V([\d.]+)H[\d.]+Z/g)) sizes.set(fill, (sizes.get(fill) ?? 0) + (x1 - x0) * (y1 - y0));
  const [clip] = [...svg.matchAll(/<clipPath id="plot"><rect x="[\d.]+" y="[\d.]+" width="([\d.]+)" height="([\d.]+)"/g)];
  const { shape, data } = slice_of("stadium", "z", 118);
  for (const { id, color } of materials.slice(1)) {
    if (!seen.has(id)) continue;
    const share = data.reduce((n, cell) => n + (cell === id), 0) / (shape[0] * shape[1]);
    const rgb = [1, 3, 5].map((at) => Number.parseInt(color.slice(at, at + 2), 16)).join(",");
    const drawn = (sizes.get(rgb) ?? 0) / (clip[1] * clip[2]);
    assert.ok(Math.abs(drawn - share) < 1e-3 * Math.max(share, 1e-3), `${materials[id].name}: ${drawn} of the area is drawn, expected ${share}`);
  }
  await close(page);
});

// Keeps what is written and ruled on canvases from now on, in pixels.
const watch_canvas = (page) =>
  page.evaluate(() => {
    const { prototype } = CanvasRenderingContext2D;
    const drawn = (globalThis.drawn = new Map()); // the preview is another canvas
    const on = (canvas) => drawn.get(canvas) ?? drawn.set(canvas, { texts: [], frames: [], bars: [] }).get(canvas);
    const watch = (name, keep) => {
      const own = prototype[name];
      prototype[name] = function (...args) {
        keep(on(this.canvas), this.getTransform(), ...args);
        return own.apply(this, args);
      };
    };
    const box = ({ a, d, e, f }, x, y, width, height) => ({ x: a * x + e, y: d * y + f, width: a * width, height: d * height });
    watch("fillText", ({ texts }, m, text, x, y) => texts.push({ text, ...box(m, x, y, 0, 0) }));
    watch("strokeRect", ({ frames }, m, x, y, width, height) => frames.push(box(m, x, y, width, height)));
    watch("fillRect", ({ bars }, m, x, y, width, height) => height === 2 && bars.push(box(m, x, y, width, height)));
  });

// A panel's scale bar and the coordinates on both of its axes agree with each other, and with the cube from 0 to 10 m that is seen in it.
function is_true_to_scale({ width, data }, { texts }, plot, bar) {
  const [right, bottom] = [plot.x + plot.width, plot.y + plot.height];
  const numbers = texts.flatMap(({ text, x, y }) => (/^[−\d.]+$/.test(text) ? [{ value: Number(text.replace("−", "-")), x, y }] : []));
  const along = { x: numbers.filter(({ x, y }) => x >= plot.x && x <= right && y > bottom && y < bottom + 50), y: numbers.filter(({ x, y }) => y >= plot.y && y <= bottom && x < plot.x && x > plot.x - 70) };
  const length = Number.parseFloat(texts.find(({ text, y }) => / m$/.test(text) && Math.abs(y - bar.y) < 10).text);
  const inside = data.flatMap((pixel, n) => {
    const [x, y] = [n % width, Math.floor(n / width)];
    return x > plot.x + 2 && x < right - 2 && y > plot.y + 2 && y < bottom - 2 && pixel >>> 24 > 127 ? [{ x, y }] : [];
  });
  for (const d of ["x", "y"]) {
    const [first, last] = [along[d][0], along[d].at(-1)];
    assert.ok(along[d].length >= 2, `${along[d].length} numbers along ${d}`);
    const pixels = (last[d] - first[d]) / (last.value - first.value); // per metre
    assert.ok(Math.abs(Math.abs(pixels) - bar.width / length) < 1e-3 * bar.width, `a metre is ${pixels} pixels by the axis, ${bar.width / length} by the bar`);
    const places = [Math.min(...inside.map((p) => p[d])), Math.max(...inside.map((p) => p[d])) + 1].map((at) => (at - first[d]) / pixels + first.value).sort((a, b) => a - b);
    assert.ok(Math.abs(places[0]) < 2 / Math.abs(pixels) && Math.abs(places[1] - 10) < 2 / Math.abs(pixels), `what is seen lies from ${places} m along ${d}`);
  }
}

test("the view in three dimensions is saved in any size, on a clear ground, with what is seen in it", async () => {
  const page = await open_dialog("g=open&layout=3d");
  assert.equal(await page.getByLabel("Format", { exact: true }).inputValue(), "png");
  await choose(page, { Width: 3, Unit: "in", "Dots per inch": 150, Ground: "clear" });
  await screenshot(page, "figure");
  const { name, bytes } = await save(page);
  assert.equal(name, "open-3d.png");
  const { width, data } = await pixels_of(page, bytes);
  assert.equal(width, 450);
  assert.equal(data[0] >>> 24, 0, "the corner is not clear");
  const solid = (some) => some.filter((pixel) => pixel >>> 24 === 255).length;
  assert.ok(solid(data) > 0.08 * data.length, "nothing is seen");
  // The domain with its coordinates adds lines and numbers around the same picture, and four views are one sheet.
  await choose(page, { "Axes with coordinates": false });
  const plain = await pixels_of(page, (await save(page)).bytes);
  const gray = (some) => some.filter((pixel) => pixel >>> 24 > 128 && (pixel & 255) < 60 && ((pixel >> 16) & 255) < 70).length;
  assert.ok(gray(data) > gray(plain.data) + 500, `${gray(data)} dark pixels with axes, ${gray(plain.data)} without`);
  for (const what of ["four", "sides"]) {
    await choose(page, { What: what, "Axes with coordinates": true, "Scale bar": true });
    if (what === "sides") await watch_canvas(page);
    const sheet = await save(page);
    assert.equal(sheet.name, `open-${what}.png`);
    const four = await pixels_of(page, sheet.bytes);
    const quarter = (right, below) => four.data.filter((_, i) => i % four.width >= (four.width >> 1) === right && Math.floor(i / four.width) >= four.height >> 1 === below);
    for (const [right, below] of [[false, false], [true, false], [false, true], [true, true]]) assert.ok(solid(quarter(right, below)) > 300, `${what}: nothing ${right} ${below}`);
    if (what === "four") continue;
    const drawn = await page.evaluate(([width, height]) => [...globalThis.drawn].find(([canvas]) => canvas.width === width && canvas.height === height)[1], [four.width, four.height]);
    const plots = drawn.frames.filter(({ width }) => width > 50);
    assert.deepEqual([plots.length, drawn.bars.length], [3, 3], "bars in perspective, or none without it");
    plots.forEach((plot, n) => is_true_to_scale(four, drawn, plot, drawn.bars[n]));
  }
  await close(page);
});

test("what can't be made is said, and can't be saved; Escape closes, and what was typed stays", async () => {
  const page = await open_dialog("g=graded");
  await choose(page, { Width: 5, Unit: "in", "Dots per inch": 9000 });
  await page.getByText("Dots per inch: 36 to 2400.").waitFor();
  await choose(page, { Width: 100, Unit: "px", "Dots per inch": 1200 });
  await page.getByText(/too narrow for its axes/).waitFor();
  await choose(page, { Width: 5, Unit: "in", "Dots per inch": 9000, Title: "Mine" });
  assert.ok(await page.getByRole("button", { name: "Save", exact: true }).isDisabled());
  await page.keyboard.press("Escape");
  await page.getByRole("dialog").waitFor({ state: "hidden" });
  await page.waitForFunction(() => !teracell.viewer.figure.value); // a closed dialog says so later
  await page.keyboard.press("f");
  const title = page.getByLabel("Title", { exact: true });
  assert.equal(await title.inputValue(), "Mine");
  // A title from the view is of what was chosen last.
  await page.getByRole("button", { name: "Title from the view" }).click();
  await choose(page, { What: "x" });
  assert.match(await title.inputValue(), /^graded, x = /);
  await choose(page, { What: "3d" });
  assert.equal(await title.inputValue(), "graded");
  await close(page);
});
