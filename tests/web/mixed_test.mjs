// Grids that were meshed with fractions: the read-out says what mixed cells are made of, and slices show it as shades.
import assert from "node:assert/strict";
import test from "node:test";
import { after } from "node:test";
import { join } from "node:path";
import { close, folder, open_grid, point_of, screenshot, serve, server_and_browser, set_state, settled, state, view } from "./support.mjs";

const { server, browser } = await server_and_browser();
const mixed = await serve(join(folder, "mixed"));
after(async () => assert.deepEqual(await mixed.stop(), []));
const api = async (path) => (await fetch(`${mixed.url}api/v1/grids/mixed${path}`)).json();
const info = await api("");

// Mixed cells in the columns through the middle, and what the server says of them.
async function mixed_cells() {
  const middle = info.grid.cells.map((n) => n >> 1);
  const found = [];
  for (const [d, axis] of ["x", "y", "z"].entries()) {
    const across = [0, 1, 2].filter((e) => e !== d).map((e) => middle[e]);
    const { runs } = await api(`/column/${axis}/${across.join("_")}`);
    for (const { to } of runs.slice(0, -1))
      for (const at of [to - 1, to]) {
        const [i, j, k] = middle.map((x, e) => (e === d ? at : x));
        const cell = await api(`/cell?i=${i}&j=${j}&k=${k}`);
        if (cell.shares.length > 1) found.push(cell);
      }
  }
  return found;
}

const cells = await mixed_cells();
const open = (cell, rest = "") => open_grid(browser, `${mixed.url}#g=mixed&at=${cell.index.join(",")}&look=${cell.centre.join(",")}&layout=z&axes=0&lines=0${rest}`);
const zoom_to = (page, size) => page.evaluate((css) => void (teracell.viewer.zoom.value = css / teracell.viewer.axes[0].width(0)), size);

test("the cell under the pointer says its shares, and its plane is drawn in it", async () => {
  assert.ok(cells.length >= 3, `${cells.length} mixed cells`);
  for (const cell of cells.slice(0, 4)) {
    const page = await open(cell);
    await zoom_to(page, 60);
    await settled(page);
    await page.mouse.move(...(await point_of(page, "z", 3, 3)));
    const part = page.getByRole("region", { name: "Under the pointer" });
    await part.getByText("%").first().waitFor();
    const text = await part.innerText();
    for (const { name, share } of cell.shares) {
      assert.ok(text.includes(name), text);
      if (share > 0.001 && share < 0.999) assert.ok(text.includes(`${(100 * share).toFixed(1)} %`), `${share} is missing in ${text}`);
    }
    if (cell.plane) await page.waitForFunction(() => teracell.viewer.cut.value !== null);
    const cut = await state(page, "cut");
    assert.deepEqual(cut?.cell, cell.plane ? cell.index : undefined);
    if (cell.plane) assert.deepEqual(cut.plane, cell.plane);
    await screenshot(page, "mixed-cell");
    await page.mouse.move(5, 5);
    await part.getByText("%").first().waitFor({ state: "detached" });
    await page.waitForFunction(() => teracell.viewer.cut.value === null);
    await close(page);
  }
});

test("slices show mixed cells as shades, and links keep that", async () => {
  const cell = cells.find(({ shares, materials }) => shares.length === 2 && shares.every(({ share }) => share > 0.2) && materials.length === 1);
  assert.ok(cell, "no cell is well mixed");
  const page = await open(cell);
  await zoom_to(page, 40);
  await settled(page);
  const color = async () => {
    await settled(page);
    return view(page, "z").locator(".view-cells").evaluate((canvas) => [...canvas.getContext("2d").getImageData(canvas.width >> 1, canvas.height >> 1, 1, 1).data]);
  };
  const whole = await color();
  await page.getByRole("button", { name: "shares", exact: true }).click();
  const shaded = await color();
  assert.notDeepEqual(shaded, whole);
  const head = page.locator('[data-view="z"] .view-title');
  assert.match(await head.innerText(), /shares$/);
  const looks = await page.evaluate(() => teracell.viewer.looks.value);
  // Over the ground, which shines through clear materials.
  const ground = [255, 255, 255];
  for (const c of [0, 1, 2]) {
    const expected = cell.shares.reduce((sum, { id, share }) => sum + share * (looks[id].opacity * looks[id].color[c] + (1 - looks[id].opacity) * ground[c]), 0);
    assert.ok(Math.abs(shaded[c] - expected) <= 255 / 16 + 6, `${shaded} at ${c}, expected ${expected}`);
  }
  await page.waitForFunction(() => location.hash.includes("shares=1"));
  const again = await open(cell, `&shares=1&zoom=${await state(page, "zoom")}`);
  await settled(again);
  assert.deepEqual(
    await view(again, "z").locator(".view-cells").evaluate((canvas) => [...canvas.getContext("2d").getImageData(canvas.width >> 1, canvas.height >> 1, 1, 1).data]),
    shaded,
  );
  await screenshot(again, "mixed-shades");
  await page.keyboard.press("s");
  assert.deepEqual(await color(), whole);
  assert.doesNotMatch(await head.innerText(), /shares/);
  await set_state(page, { show_outline: true, show_shares: true });
  assert.notDeepEqual(await color(), whole);
  await page.getByRole("button", { name: "Layers over the cells" }).click();
  assert.equal(await page.getByLabel("Mixed cells by their shares").isChecked(), true);
  await close(again);
  await close(page);
});

test("a grid without fractions has nothing of the kind", async () => {
  const page = await open_grid(browser, `${server.url}#g=stadium&shares=1`);
  await page.getByRole("button", { name: "Layers over the cells" }).click();
  assert.equal(await page.getByLabel("Mixed cells by their shares").count(), 0);
  await close(page);
});
