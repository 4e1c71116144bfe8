// Measuring snaps to boundaries and says what lies between; thickness at a click; boxes with handles are taken out as files.
import assert from "node:assert/strict";
import test from "node:test";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { close, column_of, folder, grid_file, info_of, open_grid, point_of, screenshot, server_and_browser, settled, state, view } from "./support.mjs";

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
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("link", { name: `Save as .${ending}` }).click()]);
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
