// The slice views: whatever gesture or key led there, they show what `teracell slice` gives.
import assert from "node:assert/strict";
import test from "node:test";
import {
  close, expected_labels, grids, info_of, offset_in, open_grid, open_page, packed, pixels, point_of, quiet, screenshot, server_and_browser, settled,
  state, view,
} from "./support.mjs";

const { server, browser } = await server_and_browser();

const open = (grid, rest = "") => open_grid(browser, `${server.url}#g=${grid}${rest}`);

const color_of = (material) => {
  const channel = (at) => Number.parseInt(material.color.slice(at, at + 2), 16);
  return packed(channel(1), channel(3), channel(5));
};

// Compares the pixels of a view with the cells. Each material must have one colour: its own if it is opaque and `shown` says that it
// is visible, otherwise that of the ground. Returns the share of each material.
async function expect_cells(page, grid, axis, shown = () => true) {
  await settled(page);
  const where = await page.evaluate(() => ({
    cell: teracell.viewer.cell.value, centre: teracell.viewer.centre.value, zoom: teracell.viewer.zoom.value,
  }));
  const { width, height, data } = await pixels(page, axis);
  const labels = expected_labels(grid, axis, where, width, height);
  const { materials } = info_of(grid);
  const counts = materials.map(() => 0);
  let ground = null;
  let wrong = 0;
  labels.forEach((label, i) => {
    if (label < 0) return;
    ++counts[label];
    const clear = materials[label].color.endsWith("00") && materials[label].color.length === 9;
    if (clear || !shown(label)) ground ??= data[i];
    if (data[i] !== (clear || !shown(label) ? ground : color_of(materials[label]))) ++wrong;
  });
  assert.equal(wrong, 0, `${wrong} of ${labels.length} pixels of the slice across ${axis} are wrong`);
  return counts.map((n) => n / labels.length);
}

// Makes cells several pixels large, so that each pixel shows one cell, without lines between them.
async function look(page, cell, zoom) {
  await page.evaluate(
    ({ cell, zoom }) => {
      const { viewer } = teracell;
      viewer.show_lines.value = false;
      viewer.go_to_cell(cell);
      viewer.zoom.value = zoom;
    },
    { cell, zoom },
  );
  await settled(page);
}

test("every view shows the cells of its slice, pixel by pixel", async () => {
  const page = await open("stadium");
  const step = info_of("stadium").grid.axes[0].step;
  for (const cell of [[300, 60, 30], [120, 240, 20]]) {
    await look(page, cell, 4 / step);
    const seen = [];
    for (const axis of ["x", "y", "z"]) seen.push(...(await expect_cells(page, "stadium", axis)).filter((share) => share > 0.005));
    assert.ok(seen.length >= 5, "there is too little to see");
  }
  await screenshot(page, "stadium-cells");
  await close(page);
});

test("graded axes are true to scale", async () => {
  const page = await open("graded");
  await page.evaluate(() => (teracell.viewer.show_lines.value = false));
  await screenshot(page, "graded");
  for (const [cell, zoom] of [[[50, 30, 8], 12], [[110, 30, 15], 5], [[3, 5, 2], 60]]) {
    await look(page, cell, zoom);
    for (const axis of ["x", "y", "z"]) await expect_cells(page, "graded", axis);
  }
  // In the whole domain, steel fills half of the width, although it has 113 of 130 cells.
  await page.keyboard.press("0");
  await settled(page);
  const { width, height, data } = await pixels(page, "z");
  const zoom = await state(page, "zoom");
  const steel = packed(0x3a, 0x6e, 0xa5);
  const [from, to] = [0, 100].map((x) => Math.round(width / 2 + (x - 50) * zoom));
  const row = data.subarray(Math.floor(height / 2) * width, (Math.floor(height / 2) + 1) * width);
  const share = row.subarray(from, to).filter((pixel) => pixel === steel).length / (to - from);
  assert.ok(Math.abs(share - 0.48) < 0.02, `steel is ${share} of the width`); // the plate of gold takes 2 of its 50 mm
  await close(page);
});

test("the wheel scrolls by one slice, or with shift by ten", async () => {
  const page = await open("stadium");
  await page.mouse.move(...(await point_of(page, "z")));
  const [i, j, k] = await state(page, "cell");
  const wheel = async (by, key) => {
    if (key) await page.keyboard.down(key);
    await page.mouse.wheel(0, by);
    if (key) await page.keyboard.up(key);
  };
  const leads_to = (...cell) => page.waitForFunction((expected) => String(teracell.viewer.cell.value) === expected, String(cell));
  await wheel(100);
  await leads_to(i, j, k + 1);
  await wheel(-100);
  await leads_to(i, j, k);
  await wheel(-100, "Shift");
  await leads_to(i, j, k - 10);
  await page.mouse.move(...(await point_of(page, "x")));
  await wheel(100);
  await leads_to(i + 1, j, k - 10);
  await page.mouse.move(...(await point_of(page, "y")));
  await wheel(-100, "Shift");
  await leads_to(i + 1, j - 10, k - 10);
  // The wheel may be turned as fast as possible, and never leads out of the grid.
  for (let n = 0; n < 60; ++n) await page.mouse.wheel(0, -100);
  await leads_to(i + 1, Math.max(0, j - 70), k - 10);
  await look(page, await state(page, "cell"), 4 / info_of("stadium").grid.axes[0].step);
  await expect_cells(page, "stadium", "y");
  for (let n = 0; n < 40; ++n) await wheel(-100, "Shift");
  await leads_to(i + 1, 0, k - 10);
  await close(page);
});

test("ctrl and the wheel zoom at the pointer, a drag moves the picture by its own length, a right click recentres", async () => {
  const page = await open("stadium");
  const at = (centre, zoom, dx, dy) => [centre[0] + dx / zoom, centre[1] - dy / zoom]; // of the view across z
  const [x, y] = await point_of(page, "z", 120, -70);
  const offset = await offset_in(page, "z", [x, y]);
  const start = { centre: await state(page, "centre"), zoom: await state(page, "zoom") };
  await page.mouse.move(x, y);
  await page.keyboard.down("Control");
  for (let n = 0; n < 5; ++n) await page.mouse.wheel(0, -100);
  await page.keyboard.up("Control");
  await page.waitForFunction((zoom) => teracell.viewer.zoom.value > 1.5 * zoom, start.zoom);
  await settled(page);
  const near = { centre: await state(page, "centre"), zoom: await state(page, "zoom") };
  const [p, q] = [at(start.centre, start.zoom, ...offset), at(near.centre, near.zoom, ...offset)];
  p.forEach((value, d) => assert.ok(Math.abs(value - q[d]) < 0.01 / near.zoom, `the point under the pointer moved: ${p} to ${q}`));

  await page.mouse.down();
  await page.mouse.move(x - 50, y + 30, { steps: 5 });
  await page.mouse.up();
  await settled(page);
  const moved = await state(page, "centre");
  assert.ok(Math.abs((moved[0] - near.centre[0]) * near.zoom - 50) < 1.5 && Math.abs((moved[1] - near.centre[1]) * near.zoom - 30) < 1.5);
  assert.deepEqual(await state(page, "pinned"), null, "a drag is not a click");

  await page.mouse.click(x - 100, y + 60, { button: "right" });
  await settled(page);
  const { grid } = info_of("stadium");
  const [cell, centre] = [await state(page, "cell"), await state(page, "centre")];
  const expected = at(moved, near.zoom, offset[0] - 100, offset[1] + 60);
  for (const d of [0, 1]) {
    assert.equal(cell[d], Math.floor((expected[d] - grid.axes[d].min) / grid.axes[d].step));
    assert.ok(Math.abs(centre[d] - expected[d]) <= grid.axes[d].step);
  }
  await expect_cells(page, "stadium", "x").catch(async () => {
    // At this zoom a pixel may hold several cells, so the test looks closer.
    await look(page, cell, 4 / grid.axes[0].step);
    await expect_cells(page, "stadium", "x");
  });
  await close(page);
});

test("a click puts the crosshair on the cell, and the other views follow", async () => {
  const page = await open("stadium");
  await look(page, [300, 120, 25], 4 / info_of("stadium").grid.axes[0].step);
  const { centre, zoom } = { centre: await state(page, "centre"), zoom: await state(page, "zoom") };
  const { grid } = info_of("stadium");
  const cell_of = (d, coordinate) => Math.floor((coordinate - grid.axes[d].min) / grid.axes[d].step);
  const click = async (axis, dx, dy) => {
    const point = await point_of(page, axis, dx, dy);
    await page.mouse.click(...point);
    await settled(page);
    return offset_in(page, axis, point);
  };
  const [a, b] = await click("z", 61, 37);
  assert.deepEqual(await state(page, "cell"), [cell_of(0, centre[0] + a / zoom), cell_of(1, centre[1] - b / zoom), 25]);
  for (const axis of ["x", "y", "z"]) await expect_cells(page, "stadium", axis);
  const [c, d] = await click("x", -50, -22);
  assert.deepEqual((await state(page, "cell")).slice(1), [cell_of(1, centre[1] + c / zoom), cell_of(2, centre[2] - d / zoom)]);
  for (const axis of ["y", "z"]) await expect_cells(page, "stadium", axis);
  await close(page);
});

test("the keys", async () => {
  const page = await open("stadium");
  await page.mouse.move(...(await point_of(page, "y")));
  const [i, j, k] = await state(page, "cell");
  await page.keyboard.press(".");
  assert.deepEqual(await state(page, "cell"), [i, j + 1, k]);
  await page.keyboard.press(",");
  await page.keyboard.press("Shift+<");
  assert.deepEqual(await state(page, "cell"), [i, j - 10, k]);
  for (const [key, name] of [["a", "show_axes"], ["b", "show_scale"], ["l", "show_lines"], ["e", "show_outline"]]) {
    const was = await state(page, name);
    await page.keyboard.press(key);
    assert.equal(await state(page, name), !was, key);
    await page.keyboard.press(key);
    assert.equal(await state(page, name), was, key);
  }
  await page.keyboard.press("Space");
  assert.equal(await state(page, "layout"), "y");
  await settled(page);
  await screenshot(page, "stadium-y-alone");
  assert.ok(await view(page, "y").isVisible());
  assert.ok(!(await view(page, "z").isVisible()));
  await page.keyboard.press("Space");
  assert.equal(await state(page, "layout"), "four");
  await settled(page); // the zoom follows the sizes of the views
  const zoom = await state(page, "zoom");
  await page.keyboard.press("+");
  assert.equal(await state(page, "zoom"), 2 * zoom);
  const across_z = page.locator('[data-view="z"]');
  await across_z.getByRole("button", { name: "Zoom in" }).click();
  assert.equal(await state(page, "zoom"), 4 * zoom);
  await page.keyboard.press("1");
  await settled(page);
  assert.equal(await page.evaluate(() => teracell.viewer.level[2].value), 0);
  await across_z.getByRole("button", { name: "Zoom to fit" }).click();
  await settled(page);
  assert.ok(Math.abs((await state(page, "zoom")) / zoom - 1) < 1e-9);
  await page.keyboard.press("h");
  const help = page.getByRole("dialog");
  await help.waitFor();
  assert.match(await help.innerText(), /next or previous slice/);
  await screenshot(page, "help");
  await page.keyboard.press("Escape");
  await help.waitFor({ state: "hidden" });
  await close(page);
});

// How much of the room in the views in sight the grid takes: 1 when it just fits.
const reach = (page) =>
  page.evaluate(() => {
    const { axes, zoom } = teracell.viewer;
    const shown = [...document.querySelectorAll(".view-panel:not([hidden]) .view-body")].map((body) => [body, body.parentElement.dataset.view]);
    const extent = (d) => (axes[d].max - axes[d].min) * zoom.value;
    const frames = { x: [1, 2], y: [0, 2], z: [0, 1] };
    const reaches = ([body, name]) => [extent(frames[name][0]) / (body.clientWidth - 88), extent(frames[name][1]) / (body.clientHeight - 88)];
    return Math.max(...shown.flatMap(reaches));
  });
const expect_fit = async (page, fits = true) => {
  await settled(page);
  const found = await reach(page);
  assert.equal(Math.abs(found - 1) < 1e-9, fits, `the grid takes ${found} of the room`);
};

test("a grid that fits continues to fit, whatever the layout and the sizes are, until somebody zooms or moves it", async () => {
  const page = await open("stadium");
  const layout = (name) => page.evaluate((to) => (teracell.viewer.layout.value = to), name);
  await expect_fit(page);
  for (const name of ["x", "z", "3d", "four", "y", "four"]) {
    await layout(name);
    if (name !== "3d") await expect_fit(page);
  }
  const { width } = await view(page, "x").boundingBox();
  await page.getByRole("button", { name: "Side panel" }).click();
  await page.waitForFunction((was) => document.querySelector('[data-view="x"] .view-body').clientWidth > was, Math.ceil(width));
  await expect_fit(page);
  // The address of a page whose grid fits opens a page whose grid fits.
  await page.waitForFunction((zoom) => location.hash.includes(`zoom=${zoom}`), await state(page, "zoom"));
  await page.reload();
  await expect_fit(page);
  await layout("x");
  await expect_fit(page);
  await page.mouse.move(...(await point_of(page, "x")));
  await page.keyboard.press("+");
  const zoom = await state(page, "zoom");
  await layout("four");
  await expect_fit(page, false);
  assert.equal(await state(page, "zoom"), zoom);
  await page.keyboard.press("0");
  await expect_fit(page);
  await page.keyboard.press("ArrowLeft");
  const moved = await state(page, "zoom");
  await layout("x");
  await expect_fit(page, false);
  assert.equal(await state(page, "zoom"), moved);
  await close(page);
});

test("a zoom in the address is kept within the limits of zooming", async () => {
  for (const [asked, expected] of [["1e9", (step) => 160 / step], ["1e-9", (step, fitting) => fitting / 10]]) {
    const page = await open("stadium", `&zoom=${asked}`);
    const zoom = await state(page, "zoom");
    await page.keyboard.press("0");
    await settled(page);
    const { step } = info_of("stadium").grid.axes[0];
    assert.ok(Math.abs(zoom / expected(step, await state(page, "zoom")) - 1) < 1e-9, `${zoom}`);
    await close(page);
  }
});

test("keys act on the view whose panel is in use, with its bar and the overview, and controls let pass the keys that they don't use", async () => {
  const page = await open("stadium");
  const [i, j, k] = await state(page, "cell");
  await page.mouse.move(...(await point_of(page, "z")));
  await page.locator('[data-view="x"] .slice-bar').hover();
  await page.keyboard.press(".");
  assert.deepEqual(await state(page, "cell"), [i + 1, j, k]);
  await page.getByRole("slider", { name: "Slice across y", exact: true }).focus();
  await page.keyboard.press(".");
  assert.deepEqual(await state(page, "cell"), [i + 1, j + 1, k]);
  await page.locator('[data-view="3d"]').hover({ position: { x: 60, y: 120 } });
  await page.keyboard.press(".");
  assert.deepEqual(await state(page, "cell"), [i + 1, j + 2, k]);
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("Space");
  assert.equal(await state(page, "layout"), "3d");
  await page.keyboard.press("Space");
  assert.equal(await state(page, "layout"), "four");
  // A checkbox, a colour and a slider keep only their own keys.
  await page.evaluate(() => {
    const box = document.querySelector("#side-panel").appendChild(document.createElement("input"));
    box.type = "checkbox";
    box.id = "box";
  });
  for (const control of [
    page.locator("#box"),
    page.getByLabel(/^Colour of/).first(),
    page.getByRole("slider", { name: "Slice across x", exact: true }),
  ]) {
    await control.focus();
    const outlines = await state(page, "show_outline");
    await page.keyboard.press("e");
    assert.equal(await state(page, "show_outline"), !outlines);
    await page.keyboard.press("h");
    await page.getByRole("dialog").waitFor();
    await page.keyboard.press("h");
    await page.getByRole("dialog").waitFor({ state: "hidden" });
  }
  await page.locator("#box").press("Space");
  assert.ok(await page.locator("#box").isChecked());
  assert.equal(await state(page, "layout"), "four");
  await close(page);
});

test("a double click shows one view alone, and leaves the crosshair and the pin as they were", async () => {
  const page = await open("stadium");
  await page.mouse.click(...(await point_of(page, "z", 40, 30)));
  const [cell, pinned] = [await state(page, "cell"), await state(page, "pinned")];
  assert.deepEqual(cell, pinned);
  await page.mouse.dblclick(...(await point_of(page, "x", -50, 10)));
  assert.equal(await state(page, "layout"), "x");
  assert.deepEqual([await state(page, "cell"), await state(page, "pinned")], [cell, pinned]);
  await close(page);
});

test("on a touch screen a long press recentres, unless the finger moves or a second one comes; buttons step by one slice", async () => {
  const page = await open_grid(browser, `${server.url}#g=stadium`, { width: 820, height: 1180, hasTouch: true });
  const session = await page.context().newCDPSession(page);
  const touch = (type, ...points) => session.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const [x, y] = await point_of(page, "z", 50, 30);
  const { centre, zoom } = { centre: await state(page, "centre"), zoom: await state(page, "zoom") };
  await touch("touchStart", [x, y]);
  await page.waitForFunction((was) => teracell.viewer.centre.value[0] !== was, centre[0]);
  await touch("touchEnd");
  const [there, cell] = [await state(page, "centre"), await state(page, "cell")];
  const offset = await offset_in(page, "z", [x, y]);
  const { step } = info_of("stadium").grid.axes[0];
  assert.ok(Math.abs(there[0] - centre[0] - offset[0] / zoom) <= step && Math.abs(there[1] - centre[1] + offset[1] / zoom) <= step);
  assert.equal(await state(page, "pinned"), null, "a long press is not a tap");
  assert.ok(!(await page.getByRole("region", { name: "Under the pointer" }).isVisible()), "a finger points at nothing while it is not down");
  await touch("touchStart", [x, y]);
  await touch("touchMove", [x + 30, y]);
  await page.waitForTimeout(700); // longer than a long press
  await touch("touchEnd");
  await touch("touchStart", [x, y]);
  await touch("touchStart", [x, y], [x + 40, y]);
  await page.waitForTimeout(700);
  await touch("touchEnd");
  assert.deepEqual(await state(page, "cell"), cell);
  await page.getByRole("button", { name: "Next slice across y" }).tap();
  await page.getByRole("button", { name: "Previous slice across x" }).tap();
  assert.deepEqual(await state(page, "cell"), [cell[0] - 1, cell[1] + 1, cell[2]]);
  await close(page);
});

test("a ruler's labels interrupt the crosshair's lines", async () => {
  const page = await open("stadium", "&at=300,240,60");
  const same_as_line = await page.evaluate(() => {
    const overlay = document.querySelector('[data-view="z"] .view-overlay');
    const { centre, zoom, cell, axes } = teracell.viewer;
    const x = Math.floor(overlay.width / 2 + (axes[0].centre(cell.value[0]) - centre.value[0]) * zoom.value);
    const pixel = (y) => String(overlay.getContext("2d").getImageData(x, y, 1, 1).data);
    const line = pixel(overlay.height - 40);
    return Array.from({ length: 12 }, (_, i) => pixel(overlay.height - 20 + i) === line);
  });
  assert.deepEqual(new Set(same_as_line), new Set([false]));
  await close(page);
});

test("keys go to the view under the pointer, whatever a click has left the focus on; the tab key gives them back to a slider", async () => {
  const page = await open("stadium");
  await page.waitForSelector('.overview[data-state="sharp"]');
  const opacity = page.getByLabel(/^Opacity of/).nth(1);
  const slider = page.getByRole("slider", { name: "Slice across z", exact: true });
  const [i, j, k] = await state(page, "cell");
  const percent = await opacity.inputValue();
  const keeps = async (what) => {
    assert.deepEqual([await state(page, "cell"), await opacity.inputValue()], [[i, j, k], percent], what);
    assert.equal(await page.evaluate(() => Math.max(...[...document.querySelectorAll("*")].map((e) => e.scrollTop))), 0, `${what} scrolls`);
  };
  // A click gives the slider of a bar and one of the panel the focus, and leaves their values as they are.
  for (const control of [slider, opacity]) {
    const { x, y, width, height } = await control.boundingBox();
    const { min, max, value } = await control.evaluate(({ min, max, value }) => ({ min: Number(min), max: Number(max), value: Number(value) }));
    await page.mouse.click(x + 8 + ((width - 16) * (value - min)) / (max - min), y + height / 2);
    await page.evaluate(([cell, at]) => { teracell.viewer.cell.value = cell; teracell.viewer.pinned.value = at; }, [[i, j, k], null]);
    await page.mouse.move(...(await point_of(page, "y")));
    const fitting = await state(page, "zoom");
    await page.keyboard.press("+");
    await page.keyboard.press("ArrowLeft");
    assert.ok((await state(page, "zoom")) > fitting);
    await page.keyboard.press("Home");
    await expect_fit(page);
    await page.locator('[data-view="3d"] canvas').hover(); // it has never been clicked
    const home = await state(page, "orbit");
    await page.keyboard.press("ArrowRight");
    await page.waitForFunction((was) => JSON.stringify(teracell.viewer.orbit.value) !== was, JSON.stringify(home));
    await page.keyboard.press("Home");
    await page.waitForFunction(() => teracell.viewer.orbit.value === null);
    await keeps("a slider that was clicked");
  }
  // The pointer still lies on the overview.
  await page.keyboard.press("Tab");
  await page.keyboard.press("Shift+Tab");
  await page.keyboard.press("ArrowLeft");
  assert.equal(await opacity.inputValue(), String(Number(percent) - 1));
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  assert.deepEqual(await state(page, "cell"), [i, j, k + 1]);
  // On the control itself, the pointer is not on the view.
  await slider.hover();
  await page.mouse.down();
  await page.mouse.up();
  const [, , at] = await state(page, "cell");
  await page.keyboard.press("ArrowRight");
  assert.deepEqual(await state(page, "cell"), [i, j, at + 1]);
  await close(page);
});

test("keys act on a view that is alone; with the overview alone, keys for slices do no harm", async () => {
  const page = await open("stadium", "&layout=x");
  const [i, j, k] = await state(page, "cell");
  await page.keyboard.press(".");
  assert.deepEqual(await state(page, "cell"), [i + 1, j, k]);
  await close(page);
  const other = await open_page(browser, `${server.url}#g=stadium&layout=3d`);
  await other.waitForFunction(() => window.teracell);
  await other.keyboard.press("ArrowRight");
  await other.evaluate(() => (teracell.viewer.layout.value = "four"));
  await settled(other);
  assert.ok((await state(other, "centre")).every(Number.isFinite));
  await close(other);
});

test("the slider, the number and the coordinate set the slice, and play sweeps it", async () => {
  const page = await open("graded");
  const { planes } = info_of("graded").grid.axes[2];
  await page.getByLabel("Slice across z, from 0 to 19").fill("7");
  await page.keyboard.press("Enter");
  assert.equal((await state(page, "cell"))[2], 7);
  const coordinate = page.getByLabel(/^Coordinate z of the slice/);
  assert.ok(Math.abs(Number(await coordinate.inputValue()) - (planes[7] + planes[8]) / 2) < 0.1 * (planes[8] - planes[7]));
  await coordinate.fill("33");
  await page.keyboard.press("Enter");
  assert.equal((await state(page, "cell"))[2], planes.findIndex((p) => p > 33) - 1);
  await coordinate.fill("nonsense");
  await page.keyboard.press("Enter");
  assert.equal(await coordinate.getAttribute("aria-invalid"), "true", "it shows the former number again, with a flash");
  assert.match(await coordinate.inputValue(), /^3\d/);
  assert.equal((await state(page, "cell"))[2], planes.findIndex((p) => p > 33) - 1);
  await page.getByRole("slider", { name: "Slice across z", exact: true }).fill("2");
  assert.equal((await state(page, "cell"))[2], 2);
  await page.getByRole("button", { name: "Play the slices across z" }).click();
  await page.waitForFunction(() => teracell.viewer.cell.value[2] >= 5);
  await page.getByRole("button", { name: "Pause z" }).click();
  const at = (await state(page, "cell"))[2];
  await page.waitForTimeout(300);
  assert.equal((await state(page, "cell"))[2], at);
  await close(page);
});

test("materials can be hidden, shown alone and given another colour, and the pixels follow at once", async () => {
  const page = await open("stadium");
  await look(page, [300, 60, 30], 4 / info_of("stadium").grid.axes[0].step);
  const whole = await expect_cells(page, "stadium", "z");
  const id = whole.indexOf(Math.max(...whole.slice(1)));
  const { name } = info_of("stadium").materials[id];
  await quiet(page);
  let requests = 0;
  // Only requests of level 0 count: the overview asks for its coarser tiles when it has time.
  page.on("request", (request) => (requests += /\/tile\/[xyz]\/\d+\/0\//.test(request.url()) ? 1 : 0));
  const show = page.getByRole("button", { name: `Show ${name}`, exact: true });
  await show.click();
  assert.equal(await show.getAttribute("aria-pressed"), "false");
  await expect_cells(page, "stadium", "z", (m) => m !== id);
  await show.click();
  const only = page.getByRole("button", { name: `Only ${name}`, exact: true });
  await only.click();
  await expect_cells(page, "stadium", "z", (m) => m === id);
  await screenshot(page, "stadium-one-material");
  await only.click();
  await expect_cells(page, "stadium", "z");
  await page.getByLabel(`Colour of ${name}`).fill("#12ab34");
  await settled(page);
  const { data } = await pixels(page, "z");
  const share = data.filter((pixel) => pixel === packed(0x12, 0xab, 0x34)).length / data.length;
  assert.ok(Math.abs(share - whole[id]) < 1e-9);
  await page.getByRole("button", { name: "Reset" }).click();
  await expect_cells(page, "stadium", "z");
  assert.equal(requests, 0, "a change of colours needs no tiles");
  await close(page);
});

test("coarse cells have the mean colour of their materials, as in the server's own pictures, except that air counts half", async () => {
  // The whole grid in a small window. Compares the picture with the server's `slice.png` of the same level, by mean colours.
  const page = await open_grid(browser, `${server.url}#g=stadium&layout=z`, { width: 500, height: 500 });
  await page.evaluate(() => (teracell.viewer.show_lines.value = false));
  await settled(page);
  const { level, cell } = await page.evaluate(() => ({ level: teracell.viewer.level[2].value, cell: teracell.viewer.cell.value }));
  assert.ok(level >= 1);
  const mean = await page.evaluate(
    async ({ level, k }) => {
      const plain = await createImageBitmap(await (await fetch(`api/v1/grids/stadium/slice/z/${k >> level}.png?level=${level}`)).blob());
      const picture = new OffscreenCanvas(plain.width, plain.height);
      const pixels = picture.getContext("2d");
      pixels.drawImage(plain, 0, 0);
      const image = pixels.getImageData(0, 0, plain.width, plain.height);
      for (let i = 3; i < image.data.length; i += 4) image.data[i] = (510 * image.data[i]) / (255 + image.data[i]);
      pixels.putImageData(image, 0, 0);
      const view = document.querySelector('[data-view="z"] .view-cells');
      const { centre, zoom, axes } = teracell.viewer;
      const x = (d, end) => view.width / 2 + (axes[d][end] - centre.value[d]) * zoom.value;
      const y = (end) => view.height / 2 - (axes[1][end] - centre.value[1]) * zoom.value;
      const box = [x(0, "min"), y("max"), x(0, "max") - x(0, "min"), y("min") - y("max")];
      const context = new OffscreenCanvas(16, 16).getContext("2d");
      const ground = view.getContext("2d").getImageData(Math.ceil(box[0]) + 1, Math.ceil(box[1]) + 1, 1, 1).data;
      const reduced = (draw) => {
        context.fillStyle = `rgb(${ground[0]} ${ground[1]} ${ground[2]})`;
        context.fillRect(0, 0, 16, 16);
        context.imageSmoothingQuality = "high";
        draw();
        return [...context.getImageData(0, 0, 16, 16).data];
      };
      const server = reduced(() => context.drawImage(picture, 0, 0, 16, 16));
      const own = reduced(() => context.drawImage(view, ...box, 0, 0, 16, 16));
      return server.reduce((sum, value, i) => sum + Math.abs(value - own[i]), 0) / server.length;
    },
    { level, k: cell[2] },
  );
  assert.ok(mean < 4, `colours differ by ${mean} of 255 in the mean`);
  await close(page);
});
