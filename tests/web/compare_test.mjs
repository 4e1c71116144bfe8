// Two slices that are compared: with one camera and one crosshair, by a wipe, by marks where they differ, and over the whole grids.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import test, { after } from "node:test";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { close, decoded_png, expected_labels, folder, open_grid, open_page, screenshot, serve, server_and_browser, settled, state } from "./support.mjs";

const { browser } = await server_and_browser();
const server = await serve(join(folder, "compared"));
after(async () => assert.deepEqual(await server.stop(), []));
const open = (hash, options) => open_grid(browser, `${server.url}#${hash}`, options);
const file = (name) => join(folder, "compared", `${name}.tcell`);
const other = (page, name) => page.evaluate((n) => teracell.other.viewer[n].value, name);
const address = (page, key) => page.evaluate((k) => new URLSearchParams(location.hash.slice(1)).get(k), key);
const body = (page, side) => page.locator(`[data-side="${side}"] .view-body`);
const mode = (page, name) => page.getByRole("button", { name, exact: true }).click();

async function point_in(page, side, dx, dy) {
  const { x, y, width, height } = await body(page, side).boundingBox();
  return [Math.round(x + width / 2 + dx), Math.round(y + height / 2 + dy)];
}
// The names of the materials that are painted at this distance from the middle of a side.
async function names_at(page, side, dx, dy) {
  const [x, y] = await point_in(page, side, dx, dy);
  return page.evaluate(
    ([which, px, py]) => {
      const exposed = which === "left" ? teracell : teracell.other;
      const ids = exposed.label_at(2, px, py);
      return ids?.map((id) => exposed.viewer.info.materials[id].name) ?? null;
    },
    [side, x, y],
  );
}

test("the button compares with a grid of as many cells; the address says so, and the views come back as they were", async () => {
  const page = await open("g=before&at=100,60,20");
  await page.getByRole("button", { name: "Compare", exact: true }).click();
  await settled(page);
  assert.equal(await page.getByLabel("Compare with").inputValue(), "after");
  await page.waitForFunction(() => new URLSearchParams(location.hash.slice(1)).get("compare") === "after");
  assert.ok(await page.evaluate(() => teracell.viewer.shows_all()));
  await screenshot(page, "compare-side");
  // A larger grid is seen as a whole as well.
  await page.getByLabel("Compare with").selectOption("coarse");
  await page.waitForFunction(() => window.teracell?.other?.viewer.info.id === "coarse" && teracell.idle());
  assert.ok(await page.evaluate(() => teracell.viewer.shows_all()));
  assert.equal((await state(page, "centre"))[0], 45);
  await page.getByLabel("Compare with").selectOption("after");
  await page.waitForFunction(() => window.teracell?.other?.viewer.info.id === "after" && teracell.idle());
  await page.waitForFunction(() => new URLSearchParams(location.hash.slice(1)).get("compare") === "after");
  await page.reload();
  await settled(page);
  assert.equal(await page.evaluate(() => teracell.other.viewer.info.id), "after");
  await page.getByRole("button", { name: "End the comparison" }).click();
  await settled(page);
  assert.equal(await page.locator(".view-panel:visible").count(), 4);
  assert.ok(await page.evaluate(() => teracell.viewer.shows_all()));
  await page.waitForFunction(() => !new URLSearchParams(location.hash.slice(1)).has("compare"));
  await close(page);
});

test("one camera: a drag and a zoom on either side move both, and the same place is at the same point, whatever cells and units", async () => {
  const page = await open("g=before&compare=coarse&look=50,30,20&zoom=6");
  assert.equal(await page.evaluate(() => teracell.other.viewer.units), "mm");
  assert.deepEqual(await names_at(page, "left", -210, 30), ["steel"]); // x = 15, y = 25
  assert.deepEqual(await names_at(page, "right", -210, 30), ["steel"]);
  assert.deepEqual(await names_at(page, "left", 132, 60), ["air"]); // x = 72, y = 20
  assert.deepEqual(await names_at(page, "right", 132, 60), ["gold"]);
  await page.mouse.move(...(await point_in(page, "right", 0, 0)));
  await page.mouse.down();
  await page.mouse.move(...(await point_in(page, "right", 60, 30)), { steps: 3 });
  await page.mouse.up();
  assert.deepEqual((await state(page, "centre")).slice(0, 2).map(Math.round), [40, 35]);
  assert.deepEqual(await other(page, "centre"), await state(page, "centre"));
  await page.keyboard.press("-");
  assert.equal(await state(page, "zoom"), 3);
  assert.equal(await other(page, "zoom"), 3);
  await settled(page);
  assert.deepEqual(await names_at(page, "right", (72 - 40) * 3, (35 - 20) * 3), ["gold"]);
  // The middle goes beyond the grid on the left, as far as the other one reaches.
  for (let i = 0; i < 12; ++i) await page.keyboard.press("ArrowLeft");
  assert.equal((await state(page, "centre"))[0], -10);
  await close(page);
});

test("one crosshair: a click, a slice and a typed coordinate on one side move it on the other", async () => {
  const page = await open("g=before&compare=coarse&look=50,30,20&zoom=6");
  await page.mouse.click(...(await point_in(page, "left", 134, 58)));
  const [at, there] = [await state(page, "cell"), await other(page, "cell")];
  assert.deepEqual(at.slice(0, 2), [144, 40]);
  assert.deepEqual(there.slice(0, 2), [Math.floor((72.25 + 10) / (110 / 33)), Math.floor(20.25 / (60 / 17))]);
  assert.equal(await state(page, "pinned"), null);
  await page.locator('[data-side="right"]').getByLabel(/^Slice across z, from/).fill("9");
  await page.keyboard.press("Enter");
  assert.deepEqual([(await other(page, "cell"))[2], (await state(page, "cell"))[2]], [9, Math.floor((9.5 * 40) / 11)]);
  await page.getByLabel("Move together").uncheck();
  await page.mouse.move(...(await point_in(page, "left", 0, 0)));
  await page.keyboard.press(",");
  assert.deepEqual([(await other(page, "cell"))[2], (await state(page, "cell"))[2]], [9, Math.floor((9.5 * 40) / 11) - 1]);
  await page.waitForFunction(() => new URLSearchParams(location.hash.slice(1)).get("together") === "0");
  const [before, again] = [await other(page, "cell"), page];
  await again.reload();
  await settled(again);
  assert.deepEqual(await other(again, "cell"), before);
  await close(page);
});

test("two slices of one grid lie apart, and the read-out names the materials under the pointer in both", async () => {
  const page = await open("g=before&compare=before&at=100,60,5&together=0&apart=20&look=50,30,20&zoom=6");
  assert.equal((await other(page, "cell"))[2], 25);
  await page.mouse.move(...(await point_in(page, "left", -48, 60))); // x = 42, y = 20: gold from z = 7 to 27
  await page.locator(".compared-side", { hasText: "z = 5.5" }).getByText("air").waitFor();
  await page.locator(".compared-side", { hasText: "z = 25.5" }).getByText("gold").waitFor();
  await page.locator(".other-pointer").waitFor();
  await page.getByText("Both slices are of the same grid").waitFor();
  await close(page);
});

test("the handle of a wipe is dragged and moved by keys; the right picture is seen behind it, and the address keeps its place", async () => {
  const page = await open("g=before&compare=after&look=50,30,20&zoom=6&mode=wipe");
  const handle = page.getByRole("slider", { name: "How far the picture on the left is seen" });
  const left_edge = async () => (await body(page, "left").boundingBox()).x;
  const width = (await body(page, "left").boundingBox()).width;
  const middle = async () => {
    const box = await handle.boundingBox();
    return (box.x + box.width / 2 - (await left_edge())) / width;
  };
  assert.ok(Math.abs((await middle()) - 0.5) < 0.01);
  const in_front = async (dx) => {
    const [x, y] = await point_in(page, "left", dx, 100);
    return page.evaluate(([px, py]) => document.elementFromPoint(px, py).closest("[data-side]").dataset.side, [x, y]);
  };
  assert.deepEqual([await in_front(-100), await in_front(100)], ["left", "right"]);
  const { x, y, width: w } = await handle.boundingBox();
  await page.mouse.move(x + w / 2, y + 200);
  await page.mouse.down();
  await page.mouse.move((await left_edge()) + 0.75 * width, y + 210, { steps: 4 });
  await page.mouse.up();
  assert.ok(Math.abs((await middle()) - 0.75) < 0.01);
  assert.deepEqual([await in_front(100), await in_front(0.3 * width)], ["left", "right"]);
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("PageDown");
  assert.equal(await handle.getAttribute("aria-valuenow"), "64");
  assert.deepEqual((await state(page, "centre")).slice(0, 2), [50, 30], "the picture does not move along");
  await page.waitForFunction(() => new URLSearchParams(location.hash.slice(1)).get("wipe")?.startsWith("0.6"));
  assert.equal(await address(page, "mode"), "wipe");
  await page.keyboard.press("Home");
  assert.equal(await in_front(-100), "right");
  await screenshot(page, "compare-wipe");
  await close(page);
});

test("marks are on the pixels whose materials have other names, cell by cell at level 0", async () => {
  const page = await open("g=before&compare=after&look=50,30,20&zoom=6&mode=differs");
  await page.getByText("Compared cell by cell (level 0)").waitFor();
  const found = await page.evaluate(() => {
    const canvas = document.querySelector(".view-differences");
    const { width, height } = canvas;
    return { width, height, marks: [...new Uint32Array(canvas.getContext("2d").getImageData(0, 0, width, height).data.buffer)].map(Number) };
  });
  const at = { cell: await state(page, "cell"), centre: await state(page, "centre"), zoom: await state(page, "zoom") };
  const names = async (grid, viewer) => {
    const materials = await page.evaluate((n) => (n === "left" ? teracell : teracell.other).viewer.info.materials.map((m) => m.name), viewer);
    return [...expected_labels(`../compared/${grid}`, "z", at, found.width, found.height)].map((id) => materials[id] ?? "outside");
  };
  const [left, right] = [await names("before", "left"), await names("after", "right")];
  let marked = 0;
  found.marks.forEach((mark, i) => {
    assert.equal(mark !== 0, left[i] !== right[i], `pixel ${i % found.width} ${Math.floor(i / found.width)}`);
    marked += mark !== 0;
  });
  assert.ok(marked > 1000 && marked < found.marks.length / 4);
  await screenshot(page, "compare-differs");
  for (const axis of ["x", "y", "z"]) {
    await page.getByRole("button", { name: `Slices across ${axis}` }).click();
    await page.waitForFunction((n) => teracell.viewer.layout.value === n && teracell.idle(), axis);
    await page.waitForFunction(() => document.querySelectorAll(".view-differences").length === 1);
  }
  await page.getByLabel("Compare with").selectOption("coarse");
  await page.waitForFunction(() => window.teracell?.other?.viewer.info.id === "coarse" && teracell.idle());
  await page.evaluate(() => (teracell.viewer.zoom.value = 0.5));
  await page.getByText(/Compared at level/).waitFor();
  await close(page);
});

// OKLab of B. Ottosson, 2020, times 100: 2 is just told apart.
function oklab(hex) {
  const [r, g, b] = [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  const [l, m, s] = [[0.41222, 0.53633, 0.05145], [0.2119, 0.6807, 0.1074], [0.0883, 0.28172, 0.62998]].map(([x, y, z]) => Math.cbrt(x * r + y * g + z * b));
  return [21.0454 * l + 79.3618 * m - 0.4072 * s, 197.7998 * l - 242.8592 * m + 45.0594 * s, 2.5904 * l + 78.2772 * m - 80.8676 * s];
}

test("the colours of what differs are clear beside those that materials get, and beside each other, in both themes", () => {
  const style = readFileSync(new URL("../../web/src/style/base.css", import.meta.url), "utf8");
  const given = ["56b4e9", "e69f00", "009e73", "d55e00", "cc79a7", "f0e442", "0072b2", "377597", "956700", "00664a", "8a3d00", "844e6c"].map((hex) => oklab(`#${hex}`));
  const apart = (a, b) => Math.hypot(...a.map((x, n) => x - b[n]));
  const themes = ["added", "removed", "differs"].map((name) => [...style.matchAll(new RegExp(`--${name}: (#[0-9a-f]{6})`, "g"))].map(([, hex]) => oklab(hex)));
  for (const theme of [0, 1])
    themes.forEach((of, n) => {
      assert.ok(Math.min(...given.map((color) => apart(color, of[theme]))) > 8);
      assert.ok(themes.slice(0, n).every((other) => apart(other[theme], of[theme]) > 25));
    });
});

// The changes that `teracell render` shows of the grid that `teracell diff` writes, where the page looks: for each pixel both names, or null.
function changes_seen({ azimuth, elevation, distance, target }, [width, height]) {
  const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  const back = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
  const [grid, path] = [join(folder, "changes.tcell"), join(folder, "changes.png")];
  const run = (...args) => execFileSync(process.env.TERACELL, args, { stdio: ["ignore", "pipe", "ignore"] });
  run("diff", file("before"), file("after"), "-o", grid);
  const { materials } = JSON.parse(run("info", grid, "--json"));
  const from = target.map((x, d) => x + back[d] * distance * 50); // half of the longest side
  run("render", grid, "-o", path, "--from", from.join(","), "--at", target.join(","), "--fov", "26", "--size", `${width},${height}`, "--background", "#ff00ff", "--flat");
  const names = new Map(materials.map(({ name, color }) => [Number.parseInt(color.slice(1, 7), 16), name.split(" → ")]));
  return Array.from(decoded_png(readFileSync(path)).data, (pixel) => names.get(((pixel & 255) << 16) | (pixel & 0xff00) | ((pixel >> 16) & 255)) ?? null);
}

test("in three dimensions both grids turn together, and what differs has the colour of its kind, as `diff` and `render` show it", async () => {
  const page = await open_page(browser, `${server.url}#g=before&compare=after&space=1`);
  const sharp = (count) => page.waitForFunction((n) => document.querySelectorAll('.overview[data-state="sharp"]').length === n, count);
  await sharp(2);
  const boxes = await page.locator(".overview > canvas").evaluateAll((all) => all.map((e) => e.getBoundingClientRect().toJSON()));
  assert.ok(boxes[0].right <= boxes[1].left && Math.abs(boxes[0].width - boxes[1].width) <= 1);
  await page.mouse.move(boxes[1].left + 100, boxes[1].top + 200);
  await page.mouse.down();
  await page.mouse.move(boxes[1].left + 160, boxes[1].top + 170, { steps: 3 });
  await page.mouse.up();
  const orbit = await other(page, "orbit");
  assert.ok(orbit !== null && orbit.azimuth !== -122);
  assert.deepEqual(await state(page, "orbit"), orbit, "one camera for both");
  await screenshot(page, "compare-3d-side");
  await mode(page, "What differs");
  await sharp(1);
  assert.equal(await state(page, "bodies"), "whole");
  await settled(page);
  const { left, top, width, height } = (await page.locator(".overview > canvas").evaluate((e) => e.getBoundingClientRect().toJSON()));
  const size = [Math.round(width), Math.round(height)];
  const picture = await screenshot(page, "compare-3d-differs");
  const hue_at = (i) => {
    const pixel = picture.data[(Math.round(top) + Math.floor(i / size[0])) * picture.width + Math.round(left) + (i % size[0])];
    const [r, g, b] = [pixel & 255, (pixel >> 8) & 255, (pixel >> 16) & 255];
    return g > r + 25 ? "added" : b > r + 40 && r > g + 25 ? "other" : r > b + 40 ? "removed" : "neither";
  };
  const counts = { added: [0, 0], removed: [0, 0], other: [0, 0], neither: [0, 0] };
  for (const [i, change] of changes_seen(orbit, size).entries()) {
    const expected = change === null ? "neither" : change[0] === "air" ? "added" : change[1] === "air" ? "removed" : "other";
    ++counts[expected][0];
    if (hue_at(i) === expected) ++counts[expected][1];
  }
  for (const [name, [all, right]] of Object.entries(counts)) {
    assert.ok(all > 500, `${all} pixels ${name}`);
    assert.ok(right > 0.95 * all, `${name}: ${right} of ${all}`); // lines and rulers lie over some
  }
  await page.waitForFunction(() => new URLSearchParams(location.hash.slice(1)).get("space") === "1");
  await mode(page, "Wipe");
  await sharp(2);
  await screenshot(page, "compare-3d-wipe");
  // Cells of another size and unit: surfaces within a cell of each other are the same.
  await page.getByLabel("Compare with").selectOption("coarse");
  await mode(page, "What differs");
  await page.waitForFunction(() => window.teracell?.other?.viewer.info.id === "coarse");
  await sharp(1);
  await screenshot(page, "compare-3d-coarse");
  await page.getByRole("button", { name: "Slices across z" }).click();
  await settled(page);
  await close(page);
});

// Of both grids, by the program.
async function names_at_crosshair(page) {
  const [i, j, k] = await state(page, "cell");
  return Promise.all(["before", "after"].map(async (grid) => (await (await fetch(`${server.url}api/v1/grids/${grid}/cell?i=${i}&j=${j}&k=${k}`)).json()).materials[0].name));
}

test("the whole grids are counted as teracell diff counts them, and a change is gone to where it is", async () => {
  const expected = JSON.parse(execFileSync(process.env.TERACELL, ["diff", file("before"), file("after"), "--json"]));
  const page = await open("g=before&compare=after&mode=differs");
  const digits = async (locator) => (await locator.textContent()).replace(/\D/g, "");
  assert.equal(await digits(page.locator(".comparison-panel section + p b")), String(expected.cells - expected.same));
  const lines = page.locator(".change");
  assert.equal(await lines.count(), expected.changes.length);
  for (const [n, change] of expected.changes.entries()) {
    const text = await lines.nth(n).locator(".change-names").textContent();
    assert.deepEqual(text.split("→").map((name) => name.trim()), [change.from, change.to]);
    for (const [label, slice] of [["first", change.box[2]], ["middle", null], ["last", change.box[5] - 1]]) {
      const found = page.waitForResponse((response) => response.url().includes("/changed?"));
      await lines.nth(n).getByRole("button", { name: `Go there: ${label} slice` }).click();
      const { cell } = await (await found).json();
      await page.waitForFunction((there) => String(teracell.viewer.cell.value) === String(there), cell);
      await settled(page);
      if (slice !== null) assert.equal((await state(page, "cell"))[2], slice);
      assert.deepEqual(await other(page, "cell"), await state(page, "cell"));
      assert.deepEqual(await names_at_crosshair(page), [change.from, change.to]);
      assert.deepEqual(await state(page, "box"), change.box);
    }
  }
  const sum = (is) => expected.changes.filter(is).reduce((cells, change) => cells + change.cells, 0);
  const totals = [sum(({ from }) => from === "air"), sum(({ to }) => to === "air"), sum(({ from, to }) => from !== "air" && to !== "air")];
  for (const [n, total] of totals.entries()) assert.equal(await digits(page.locator(".comparison-panel .comparison-marks b").nth(n)), String(total));
  // The view in three dimensions comes to the change that was gone to last.
  const { box } = expected.changes.at(-1);
  await page.getByRole("button", { name: /^3D/ }).click();
  await page.waitForFunction((b) => {
    const { layout, orbit, axes } = window.teracell?.viewer ?? {}; // none while one pair goes and the other comes
    const target = layout?.value === "3d" && orbit.value?.target;
    return target && axes.every((axis, d) => axis.cell_at(target[d]) >= b[d] && axis.cell_at(target[d]) <= b[d + 3]);
  }, box);
  assert.deepEqual(await state(page, "box"), box);
  await mode(page, "Wipe");
  assert.equal(await state(page, "bodies"), "cut", "whole bodies would hide it");
  const cell = await state(page, "cell");
  await page.getByRole("button", { name: "End the comparison" }).click();
  await settled(page);
  assert.deepEqual(await state(page, "cell"), cell);
  assert.ok(await page.evaluate(() => teracell.viewer.shows_all()));
  await close(page);
});

test("grids of other cells are not counted, and that is said in words; so is a grid that is not there", async () => {
  const page = await open("g=before&compare=coarse");
  await page.getByText("only where both grids have the same ones: one is in mm, the other in cm").waitFor();
  await close(page);
  const missing = await open_page(browser, `${server.url}#g=before&compare=gone`);
  await missing.getByText("There is no grid “gone” here").waitFor();
  await missing.getByLabel("Compare with").selectOption("after");
  await settled(missing);
  await close(missing);
});

test("where one grid ends, the nearest slice is shown, that is said, and nothing is marked", async () => {
  const page = await open("g=before&compare=coarse&across=x&mode=differs");
  assert.equal(await page.locator(".view-differences:visible").count(), 1);
  await page.locator('[data-side="right"]').getByLabel(/^Slice across x, from/).fill("0");
  await page.keyboard.press("Enter");
  await page.getByText("One grid ends here: its nearest slice is shown.").waitFor();
  await page.getByText("Nothing is marked, because the slices lie at different places.").waitFor();
  await settled(page);
  assert.equal((await state(page, "cell"))[0], 0);
  assert.equal(await page.locator(".view-differences:visible").count(), 0);
  await close(page);
});

for (const [name, width, height] of [["upright", 390, 844], ["on its side", 844, 390]])
  test(`a phone ${name} shows the whole width of each comparison, and views that can be used`, async () => {
    const page = await open("g=before&compare=after", { width, height });
    for (const label of ["Side by side", "Wipe", "What differs"]) {
      await mode(page, label);
      await settled(page);
      assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= width);
      for (const side of ["left", "right"]) {
        const box = await body(page, side).boundingBox();
        assert.ok(box.width >= 250 && box.height >= 100, `${label}: ${box.width} x ${box.height}`);
        assert.ok(box.x >= 0 && box.x + box.width <= width);
      }
      const bars = await page.locator(".slice-bar").evaluateAll((all) => all.every((bar) => bar.scrollWidth <= bar.clientWidth));
      assert.ok(bars, `${label}: a bar is cut off`);
    }
    await screenshot(page, `compare-phone-${width}`);
    if (width < height) await page.getByRole("button", { name: "Side panel" }).click();
    await page.locator(".change").first().getByRole("button", { name: "Go there: middle" }).click();
    await settled(page);
    await close(page);
  });
