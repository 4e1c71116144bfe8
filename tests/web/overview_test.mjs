// The overview in three dimensions shows what `teracell render` draws for the same camera, and names what is there.
import assert from "node:assert/strict";
import test from "node:test";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { close, decoded_png, exported_cell, folder, grid_file, info_of, open_page, screenshot, server_and_browser, set_state, state } from "./support.mjs";

const { server, browser } = await server_and_browser();

const sharp = (page) => page.waitForSelector('.overview[data-state="sharp"]');
const canvas_box = (page) => page.locator(".overview > canvas").boundingBox();
async function open(grid, rest = "", options = {}) {
  const page = await open_page(browser, `${server.url}#g=${grid}&layout=3d&panel=none${rest}`, options);
  await sharp(page);
  return page;
}
// Waits for a picture that is newer than what is shown now.
async function sharp_again(page, change) {
  await change();
  await page.waitForFunction(() => document.querySelector(".overview").dataset.state !== "sharp");
  await sharp(page);
}

// The camera of the page, as `teracell render` is told of it.
function camera_of(grid, { azimuth, elevation, distance, target }) {
  const { min, max } = info_of(grid).grid;
  const half = Math.max(...max.map((m, d) => m - min[d])) / 2;
  const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  const back = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
  return ["--from", target.map((x, d) => x + back[d] * distance * half).join(","), "--at", target.join(","), "--fov", "26"];
}
function rendered(grid, name, size, ...args) {
  const path = join(folder, `${name}.png`);
  execFileSync(process.env.TERACELL, ["render", grid_file(grid), "-o", path, "--size", size.join(","), ...args], { stdio: "ignore" });
  return decoded_png(readFileSync(path));
}

const CAMERAS = [
  ["stadium", "whole", { azimuth: 40, elevation: 5, distance: 0.5, target: [60, 50, 15] }, []],
  ["stadium", "cut", { azimuth: -70, elevation: 35, distance: 2, target: [0, 0, 15] }, ["open"]],
  ["stadium", "plane", { azimuth: -70, elevation: 35, distance: 2, target: [0, 0, 15] }, ["plane"]],
  ["graded", "whole", { azimuth: 200, elevation: 60, distance: 3, target: [20, 30, 20] }, []],
];
CAMERAS.forEach(([grid, bodies, orbit, cut], i) =>
  test(`${grid}, ${bodies}, camera ${i}: the picture at rest is that of \`teracell render\``, async () => {
    const page = await open(grid, `&bodies=${bodies}&plane=1,0.5,0.2`, { width: 900, height: 620 });
    await sharp_again(page, () => set_state(page, { orbit }));
    const { x, y, width, height } = await canvas_box(page);
    const cell = await state(page, "cell");
    const at = await page.evaluate((c) => c.map((index, d) => teracell.viewer.axes[d].centre(index)), cell);
    const args = { open: ["--open", at.join(",")], plane: ["--plane", `1,0.5,0.2,${at[0] + 0.5 * at[1] + 0.2 * at[2]}`] };
    const expected = rendered(grid, `expected-${i}`, [width, height], ...camera_of(grid, orbit), ...cut.flatMap((name) => args[name]), "--background", "#ff00ff");
    const found = await screenshot(page, `overview-${i}`);
    const off = (a, b) => Math.max(...[0, 8, 16].map((shift) => Math.abs(((a >> shift) & 255) - ((b >> shift) & 255))));
    let [seen, same] = [0, 0];
    for (let row = 0; row < height; ++row)
      for (let column = 0; column < width; ++column) {
        const wanted = expected.data[row * width + column];
        if ((wanted & 0xffffff) === 0xff00ff) continue;
        ++seen;
        if (off(wanted, found.data[(y + row) * found.width + x + column]) <= 12) ++same;
      }
    assert.ok(seen > 10_000, `${seen} pixels show something`);
    // Lines, knobs and the mean of colours with the ground at the edge of bodies are what differs.
    assert.ok(same > 0.93 * seen, `${((100 * same) / seen).toFixed(1)} % of ${seen} pixels are the same`);
    await close(page);
  }),
);

test("the pointer names what is under it and its cell; a click keeps the cell, a double click goes there", async () => {
  const page = await open("stadium", "&bodies=whole");
  const { x, y, width, height } = await canvas_box(page);
  const place = [x + Math.round(0.5 * width), y + Math.round(0.78 * height)];
  await page.mouse.move(...place);
  const tip = page.locator(".overview-tip");
  await page.waitForFunction(() => /cell \d+, \d+, \d+/.test(document.querySelector(".overview-tip").textContent));
  const under = await page.locator(".dock-pointer .index").allTextContents();
  assert.equal(under.map((text) => text.replace(/\D/g, "")).join(", "), (await tip.textContent()).match(/cell (\d+, \d+, \d+)/)[1], "the read-out names another cell");
  const [, name, ...cell] = /^(.*) · cell (\d+), (\d+), (\d+)$/.exec(await tip.textContent());
  assert.equal(info_of("stadium").materials[exported_cell("stadium", cell.map(Number))].name, name);
  await page.mouse.click(...place);
  await page.waitForFunction(() => teracell.viewer.pinned.value !== null);
  assert.deepEqual(await state(page, "pinned"), cell.map(Number));
  const far = await page.evaluate(() => teracell.viewer.orbit.value?.distance ?? 1e9);
  await sharp_again(page, () => page.mouse.dblclick(...place));
  assert.deepEqual(await state(page, "cell"), cell.map(Number));
  const orbit = await state(page, "orbit");
  assert.ok(orbit.distance < far);
  const target = await page.evaluate((p) => p.map((c, d) => teracell.viewer.axes[d].cell_at(c)), orbit.target);
  assert.ok(target.every((c, d) => Math.abs(c - cell[d]) <= 1), `${target} is not at ${cell}`);
  await page.mouse.move(x + 5, y + height - 5);
  await tip.waitFor({ state: "hidden" });
  await close(page);
});

test("the wheel ends at the surface under the pointer, and goes back to the whole", async () => {
  const page = await open("stadium", "&bodies=whole");
  const { x, y, width, height } = await canvas_box(page);
  await page.mouse.move(x + 0.5 * width, y + 0.78 * height);
  for (let i = 0; i < 60; ++i) await page.mouse.wheel(0, -240);
  await page.waitForTimeout(100);
  await sharp(page);
  const side = await page.evaluate(() => 2 / Math.max(...teracell.viewer.axes.map((axis) => axis.cells)));
  const near = await state(page, "orbit");
  assert.ok(Math.abs(near.distance - 3 * side) < 1e-6 * side, `${near.distance / side} cells away`);
  // Cells are so large now that each is some hundred pixels wide: few colours, and none of the ground.
  const picture = await screenshot(page, "overview-near");
  assert.ok(new Set(picture.data).size > 20);
  await sharp_again(page, () => page.getByRole("button", { name: "Show everything" }).click());
  assert.equal(await state(page, "orbit"), null);
  await close(page);
});

test("another colour needs no request; what is hidden shows what is behind it, and what is clear lets it through", async () => {
  const page = await open("stadium", "&bodies=whole");
  const asked = [];
  page.on("request", (request) => request.url().includes("/view.bin") && asked.push(request.url()));
  const shown = async () => new Set((await screenshot(page, "overview-looks")).data).size;
  const look = (id, change) =>
    page.evaluate(([n, to]) => {
      const looks = [...teracell.viewer.looks.value];
      looks[n] = { ...looks[n], ...to };
      teracell.viewer.looks.value = looks;
    }, [id, change]);
  const share = async (r, g, b) => {
    const { data } = await screenshot(page, "overview-looks");
    return data.filter((p) => ((p & 255) > 90) === r && (((p >> 8) & 255) > 90) === g && (((p >> 16) & 255) > 90) === b).length / data.length;
  };
  await look(3, { color: [255, 0, 0] });
  let red = 0;
  for (let n = 0; n < 100 && (red = await share(true, false, false)) <= 0.1; ++n) await page.waitForTimeout(100);
  assert.ok(red > 0.1, "the structure is not red");
  assert.deepEqual(asked, []);
  await sharp_again(page, () => look(3, { visible: false }));
  assert.ok((await share(true, false, false)) < 0.01, "the structure is not hidden"); // the x axis is red as well
  assert.ok(asked.every((url) => url.includes("labels=1-2&") || url.includes("labels=1-2")), asked[0]);
  asked.length = 0;
  await sharp_again(page, () => look(3, { visible: true, opacity: 0.4 }));
  assert.ok(asked.some((url) => /labels=3(&|$)/.test(url)) && asked.some((url) => /labels=1-2(&|$)/.test(url)), "layers are not asked for one by one");
  assert.ok((await shown()) > 100);
  await close(page);
});

test("y can be up, a plane that cuts faces the eye, and the address keeps both", async () => {
  const page = await open("stadium", "&bodies=whole");
  await sharp_again(page, () => page.getByRole("button", { name: "z is up: press for y" }).click());
  await sharp_again(page, () => page.getByRole("button", { name: "Plane" }).click());
  const normal = await state(page, "plane_normal");
  assert.ok(Math.abs(Math.hypot(...normal) - 1) < 1e-9);
  await page.waitForFunction(() => location.hash.includes("up=y") && location.hash.includes("plane="));
  const other = await open_page(browser, page.url());
  await sharp(other);
  assert.equal(await state(other, "sky"), 1);
  const back = await state(other, "plane_normal");
  assert.ok(normal.every((c, d) => Math.abs(c - back[d]) < 1e-5));
  await screenshot(other, "overview-plane");
  await close(other);
  await close(page);
});

test("what could not be fetched comes when the server is back", async () => {
  const context = await browser.newContext();
  let asked = 0;
  await context.route(/view\.bin/, (route) => (asked++ === 0 ? route.abort() : route.continue()));
  const page = await open_page(browser, `${server.url}#g=stadium`, { context, expected: (url, status) => status === 0 });
  await sharp(page);
  assert.ok(asked > 1);
  assert.equal(await page.locator(".overview-message").isHidden(), true);
  await close(page);
});

test("orbits end with as much memory as they began with", async () => {
  const page = await open("stadium", "", { width: 700, height: 500 });
  const { x, y, width, height } = await canvas_box(page);
  const heap = async () => {
    const session = await page.context().newCDPSession(page);
    await session.send("HeapProfiler.collectGarbage");
    const { usedSize } = await session.send("Runtime.getHeapUsage");
    return usedSize;
  };
  const fly = async () => {
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    for (let i = 0; i < 12; ++i) await page.mouse.move(x + width / 2 + 15 * i, y + height / 2 + 5 * i);
    await page.mouse.up();
    await page.waitForTimeout(100);
    await sharp(page);
  };
  await fly();
  const before = await heap();
  for (let i = 0; i < 6; ++i) await fly();
  const after = await heap();
  assert.ok(after < before + 7e6, `${(before / 1e6).toFixed(1)} MB before, ${(after / 1e6).toFixed(1)} MB after`);
  await close(page);
});
