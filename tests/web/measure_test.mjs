// Measuring snaps to boundaries and says what lies between, in slices and on surfaces; thickness at a click; boxes with handles are taken out as files.
import assert from "node:assert/strict";
import test from "node:test";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { close, column_of, folder, grid_file, info_of, open_grid, open_page, point_of, screenshot, server_and_browser, settled, state, view } from "./support.mjs";

const { server, browser } = await server_and_browser();

// Where a cell's row of the graded grid changes its material, in coordinates.
const boundaries = (name, axis, at) => column_of(name, axis, at).runs.slice(1).map(({ min }) => min);

async function drag(page, from, to) {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move((from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
  await page.mouse.move(...to);
  await page.waitForTimeout(400);
  await page.mouse.up();
}

// The point of the page at coordinates of a view.
const page_point = (page, axis, [a, b]) =>
  view(page, axis).evaluate(
    (body, [d, x, y]) => {
      const { centre, zoom } = teracell.viewer;
      const [u, v] = [[1, 2], [0, 2], [0, 1]][d];
      const { left, top } = body.getBoundingClientRect();
      return [left + body.clientWidth / 2 + (x - centre.value[u]) * zoom.value, top + body.clientHeight / 2 - (y - centre.value[v]) * zoom.value];
    },
    ["xyz".indexOf(axis), a, b],
  );

test("the ends of a line snap to boundaries between materials, and the panel says what it passes through", async () => {
  const page = await open_grid(browser, `${server.url}#g=graded&layout=z&at=60,30,10`);
  const [, , k] = await state(page, "cell");
  const edges = boundaries("graded", "x", [30, k]);
  assert.ok(edges.length >= 1);
  const zoom = await state(page, "zoom");
  const near = (x, pixels) => page_point(page, "z", [x + pixels / zoom, 30.4]);
  await page.keyboard.press("m");
  await drag(page, await near(edges[0], -4), await near(edges.at(-1), 100));
  await page.waitForFunction((x) => teracell.viewer.measure.value?.from[0] === x, edges[0]);
  const { from, to } = await state(page, "measure");
  const table = page.getByRole("table", { name: "What the line passes through" });
  await table.waitFor();
  const asked = await (await fetch(`${server.url}api/v1/grids/graded/line?from=${from.join(",")}&to=${to.join(",")}`)).json();
  await page.waitForFunction((n) => document.querySelectorAll('[aria-label="What the line passes through"] tbody tr').length === n, asked.runs.length);
  const rows = await table.locator("tbody tr").allTextContents();
  asked.runs.forEach(({ name, cells }, n) => assert.ok(rows[n].startsWith(name) && rows[n].replace(/\s/g, "").includes(String(cells)), rows[n]));
  await screenshot(page, "measure");
  await close(page);
});

test("with alt nothing snaps", async () => {
  const page = await open_grid(browser, `${server.url}#g=graded&layout=z&at=60,30,10`);
  const [, , k] = await state(page, "cell");
  const [edge] = boundaries("graded", "x", [30, k]);
  await page.keyboard.press("m");
  await page.keyboard.down("Alt");
  const zoom = await state(page, "zoom");
  await drag(page, await page_point(page, "z", [edge - 4 / zoom, 30.4]), await page_point(page, "z", [edge + 90 / zoom, 30.4]));
  await page.keyboard.up("Alt");
  assert.notEqual((await state(page, "measure")).from[0], edge);
  await close(page);
});

test("shift and a click measure how thick the material is along each axis", async () => {
  const page = await open_grid(browser, `${server.url}#g=stadium`);
  const at = await point_of(page, "z", 3, 2);
  await page.keyboard.down("Shift");
  await page.mouse.click(...at);
  await page.keyboard.up("Shift");
  const cell = await state(page, "thickness");
  await page.waitForFunction(() => teracell.viewer.measure.value !== null);
  const runs = ["x", "y", "z"].map((axis, d) => column_of("stadium", axis, cell.filter((_, e) => e !== d)).runs.find(({ from, to }) => from <= cell[d] && cell[d] < to));
  await page.waitForFunction(() => !document.querySelector('[role="tabpanel"]').innerText.includes("…")); // columns come one after another
  const text = await page.getByRole("tabpanel").innerText();
  for (const run of runs) assert.ok(text.replace(/\s/g, "").includes(`${run.to - run.from}cell`), `${run.to - run.from} cells are missing`);
  const { from, to } = await state(page, "measure");
  const shortest = Math.min(runs[0].max - runs[0].min, runs[1].max - runs[1].min);
  assert.ok(Math.abs(Math.hypot(...from.map((x, d) => x - to[d])) - shortest) < 1e-9);
  await page.keyboard.press("Escape");
  assert.equal(await state(page, "thickness"), null);
  await close(page);
});

// A click in the overview, at shares of its width and height.
async function click_in_space(page, [x, y], modifiers = []) {
  const { left, top, width, height } = await page.locator(".overview > canvas").evaluate((e) => e.getBoundingClientRect().toJSON());
  for (const key of modifiers) await page.keyboard.down(key);
  await page.mouse.click(left + x * width, top + y * height);
  for (const key of modifiers) await page.keyboard.up(key);
}
const lines = (page, count) => page.waitForFunction((n) => teracell.viewer.measures.value.length === n && !teracell.viewer.measuring.value, count);

test("lines between surfaces are measured in 3D by clicks, and thickness along the normal; all are listed, named, kept in the link and removed", async () => {
  const page = await open_page(browser, `${server.url}#g=graded&layout=3d&bodies=whole&panel=box&at=60,30,10`);
  await page.waitForSelector('.overview[data-state="sharp"]');
  const { grid } = info_of("graded");
  const cell_of = (p) => p.map((x, d) => {
    const axis = grid.axes[d];
    const plane = (i) => (axis.type === "graded" ? axis.planes[i] : axis.min + (axis.first + i) * axis.step);
    const cells = axis.type === "graded" ? axis.planes.length - 1 : axis.cells;
    for (let i = 0; i < cells; ++i) if (x < plane(i + 1) || i === cells - 1) return i;
  });
  // On which axes a point lies on a boundary between materials, or where the grid ends.
  const boundaries_at = (p) => [0, 1, 2].filter((d) => {
    const { runs } = column_of("graded", "xyz"[d], cell_of(p).filter((_, e) => e !== d));
    return runs.some(({ min, max }) => Math.min(Math.abs(min - p[d]), Math.abs(max - p[d])) < 1e-9 * 100);
  });
  await page.keyboard.press("m");
  await page.getByText("Click a surface at each end, or").waitFor();
  await click_in_space(page, [0.45, 0.55]);
  await page.getByText("Click a surface at the other end").waitFor();
  await click_in_space(page, [0.55, 0.5]);
  await lines(page, 1);
  const { from, to, axis } = await state(page, "measure");
  assert.equal(axis, null);
  assert.notDeepEqual(from, to);
  for (const end of [from, to]) assert.ok(boundaries_at(end).length > 0, `${end} lies on no surface`);
  await click_in_space(page, [0.45, 0.55], ["Shift"]);
  await lines(page, 2);
  const thick = await state(page, "measure");
  const way = thick.from.map((x, d) => thick.to[d] - x);
  const along = way.findIndex((x) => Math.abs(x) > 0.99 * Math.hypot(...way));
  assert.ok(along >= 0, `a side of a box is along an axis, found ${way}`);
  const at = cell_of(thick.from.map((x, d) => (x + thick.to[d]) / 2));
  const run = column_of("graded", "xyz"[along], at.filter((_, d) => d !== along)).runs.find(({ from, to }) => from <= at[along] && at[along] < to);
  assert.equal(thick.name, `Thickness of ${run.name}`);
  assert.ok(Math.abs(Math.hypot(...way) - (run.max - run.min)) < 1e-3 * (run.max - run.min), `${Math.hypot(...way)} instead of ${run.max - run.min}`);
  const first = page.getByLabel("Name of line 1");
  assert.equal(await first.inputValue(), "Line 1");
  await first.fill("from side to side");
  await first.press("Enter");
  await page.waitForFunction(() => decodeURIComponent(decodeURIComponent(location.hash)).includes("from side to side"));
  await screenshot(page, "measure_3d");
  const measures = await state(page, "measures");
  const again = await open_page(browser, page.url());
  await again.waitForSelector(".overview-length");
  assert.deepEqual(await state(again, "measures"), measures);
  await close(again);
  await page.getByRole("button", { name: "Remove from side to side" }).click();
  assert.deepEqual((await state(page, "measures")).map(({ name }) => name), [thick.name]);
  // Escape gives up a line that has no end yet, and what was there stays.
  await page.keyboard.press("m");
  await click_in_space(page, [0.45, 0.55]);
  await page.waitForFunction(() => teracell.viewer.measuring.value);
  await page.keyboard.press("Escape");
  assert.deepEqual((await state(page, "measures")).map(({ name }) => name), [thick.name]);
  await close(page);
});

test("handles change the box, its ends can be typed as lengths, and its cells are saved as files", async () => {
  const page = await open_grid(browser, `${server.url}#g=graded&layout=z&panel=box&box=10,10,2,110,50,12`, { acceptDownloads: true });
  const { grid } = info_of("graded");
  const plane = (d, i) => (grid.axes[d].type === "graded" ? grid.axes[d].planes[i] : grid.axes[d].min + (grid.axes[d].first + i) * grid.axes[d].step);
  const corner = await page_point(page, "z", [plane(0, 110), plane(1, 50)]);
  const target = await page_point(page, "z", [plane(0, 105), plane(1, 44)]);
  await drag(page, corner, target);
  assert.deepEqual(await state(page, "box"), [10, 10, 2, 105, 44, 12]);
  await page.getByRole("group", { name: "Ends of the box" }).getByRole("button", { name: "mm" }).click();
  const field = page.getByLabel("Lower end along y in mm");
  assert.equal(Number(await field.inputValue()), plane(1, 10));
  await field.fill(String(plane(1, 12) + 0.1 * (plane(1, 13) - plane(1, 12))));
  await field.press("Enter");
  const box = await state(page, "box");
  assert.deepEqual(box, [10, 12, 2, 105, 44, 12]);
  for (const ending of ["npy", "vtr"]) {
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: `Save as .${ending}` }).click()]);
    const [got, expected] = [join(folder, `got.${ending}`), join(folder, `expected.${ending}`)];
    await download.saveAs(got);
    execFileSync(process.env.TERACELL, ["export", grid_file("graded"), "-o", expected, "--region", box.join(",")], { stdio: "ignore" });
    assert.ok(readFileSync(got).equals(readFileSync(expected)), `the .${ending} differs`);
  }
  // The lines run as they stand, with NumPy and the standard library.
  const lines = await page.locator(".code-line pre").first().textContent();
  const cells = join(folder, "box.raw");
  execFileSync("/usr/bin/python3", ["-c", `${lines}\nassert cells.shape == (10, 32, 95)\ncells.tofile("${cells}")`]);
  const npy = readFileSync(join(folder, "expected.npy"));
  assert.ok(npy.subarray(npy.length - 95 * 32 * 10).equals(readFileSync(cells)));
  await settled(page);
  await screenshot(page, "box");
  await close(page);
});
