// The tools in the header, the crosshair and measuring by keys, places outside the grid, and the page on a phone.
import assert from "node:assert/strict";
import test from "node:test";
import { close, open_grid, point_of, screenshot, server_and_browser, state } from "./support.mjs";

const { server, browser } = await server_and_browser();
const open = (hash, options) => open_grid(browser, `${server.url}#${hash}`, options);

test("buttons take the tools that keys take, and show which one is taken", async () => {
  const page = await open("g=graded");
  for (const [name, tool] of [["Measure a distance", "measure"], ["Draw a box", "box"]]) {
    const button = page.getByRole("button", { name });
    await button.click();
    assert.equal(await state(page, "tool"), tool);
    assert.equal(await button.getAttribute("aria-pressed"), "true");
    await button.click();
    assert.equal(await state(page, "tool"), "look");
  }
  await page.getByRole("button", { name: "Outline materials" }).click();
  assert.equal(await state(page, "show_outline"), true);
  await page.getByRole("button", { name: "Save a figure" }).click();
  await page.getByRole("dialog", { name: "Save a figure" }).waitFor();
  await close(page);
});

test("the list of layers shows and hides what is drawn over the cells, and Escape closes it", async () => {
  const page = await open("g=graded");
  const button = page.getByRole("button", { name: "Layers over the cells" });
  await button.click();
  for (const [label, name] of [["Crosshair and axes", "show_axes"], ["Scale bar", "show_scale"], ["Lines between cells", "show_lines"]]) {
    await page.getByLabel(label).uncheck();
    assert.equal(await state(page, name), false);
  }
  await page.keyboard.press("Escape");
  assert.equal(await button.getAttribute("aria-expanded"), "false");
  await close(page);
});

test("shift and arrows move the crosshair in the plane of the slice, and Enter begins and ends a measured line there", async () => {
  const page = await open("g=graded&at=20,30,10");
  await page.mouse.move(...(await point_of(page, "z")));
  await page.keyboard.press("m");
  await page.keyboard.press("Enter");
  for (let i = 0; i < 3; ++i) await page.keyboard.press("Shift+ArrowUp");
  await page.keyboard.press("Enter");
  const [, j] = await state(page, "cell");
  const { axis, from, to } = await state(page, "measure");
  assert.ok(j > 30);
  assert.equal(axis, 2);
  assert.deepEqual([to[0] - from[0], to[1] - from[1], to[2] - from[2]], [0, j - 30, 0]);
  assert.equal(await state(page, "tool"), "look");
  await close(page);
});

test("a place outside the grid is said, in the address and in the bar", async () => {
  const page = await open("g=graded&at=5,900,3");
  await page.getByText("Cell 5, 900, 3 is outside the grid, whose last cell is 129, 59, 19").waitFor();
  await page.getByLabel(/^Coordinate z of the slice/).fill("-7");
  await page.keyboard.press("Enter");
  await page.getByText(/^z = −7.* is outside the grid/).waitFor();
  assert.equal((await state(page, "cell"))[2], 0);
  await close(page);
});

test("the field for places leads to coordinates, cells and names, says what Enter will do, and takes what the read-out copies", async () => {
  const page = await open("g=graded", { permissions: ["clipboard-read", "clipboard-write"] });
  const field = page.getByRole("combobox", { name: /^Go to a place/ });
  const goals = page.getByRole("listbox", { name: "Places" }).getByRole("option");
  const go_to = async (text) => {
    await page.keyboard.press("g");
    await page.keyboard.type(text); // the first letter is not lost
    assert.equal(await field.inputValue(), text);
    const told = await goals.allInnerTexts();
    await page.keyboard.press("Enter");
    assert.equal(await field.evaluate((e) => e === document.activeElement), false);
    return told;
  };
  assert.match((await go_to("(5.05; 20.5 30)"))[0], /^x 5\.05, y 20\.5, z 30\.0 mm\s+cell 50, 20, 17/);
  assert.deepEqual(await state(page, "cell"), [50, 20, 17]);
  // Both kinds of text are read back as the cell that they were copied from.
  for (const copy of ["Copy the place as a cell", "Copy the place in mm"]) {
    await page.evaluate(() => teracell.viewer.go_to_cell([110, 7, 3]));
    await page.getByRole("button", { name: copy }).click();
    await page.evaluate(() => teracell.viewer.go_to_cell([0, 0, 0]));
    await go_to(await page.evaluate(() => navigator.clipboard.readText()));
    assert.deepEqual(await state(page, "cell"), [110, 7, 3], copy);
  }
  // Of two meanings the second one is taken by the arrow key.
  await page.keyboard.press("g");
  await page.keyboard.type("9, 8, 7");
  assert.equal(await goals.count(), 2);
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  assert.deepEqual(await state(page, "cell"), [9, 8, 7]);
  assert.match((await go_to("9, 8, 700"))[0], /z = 700.* is outside the grid, which goes from 0.* to 40/);
  await page.locator(".toast", { hasText: "outside the grid" }).waitFor();
  assert.equal((await state(page, "cell"))[2], 19);
  // A name leads to the middle of what has it, which is alone in view.
  await go_to("gol");
  await page.waitForFunction(() => String(teracell.viewer.cell.value) === "49,29,12");
  const [x, y] = await state(page, "centre");
  assert.ok(Math.abs(x - 5) < 2 && Math.abs(y - 30) < 1);
  assert.deepEqual((await state(page, "isolated")).labels, [2]);
  await page.keyboard.press("g");
  await page.keyboard.type("nothing of the kind");
  await page.getByText("is no place, and nothing here is called so").waitFor();
  await page.keyboard.press("Escape");
  assert.equal(await state(page, "going"), false);
  await close(page);
});

test("the help offers a first minute: six steps by keys or clicks, each at what it is about, skippable, and never offered again", async () => {
  const page = await open("g=graded&layout=x&panel=none");
  const card = page.getByRole("dialog", { name: "Slices" });
  await page.keyboard.press("?");
  await page.getByRole("button", { name: "Show me" }).click();
  await card.waitFor();
  const heads = [];
  for (let n = 1; n <= 6; ++n) {
    await page.getByText(`${n} of 6`).waitFor();
    await page.waitForFunction(() => document.activeElement.closest(".tour"));
    await page.waitForFunction(() => {
      // The card lies in the window, and the ring has the size of something that is in sight.
      const { left, top, right, bottom } = document.querySelector(".tour").getBoundingClientRect();
      const ring = document.querySelector(".tour-ring")?.getBoundingClientRect();
      return left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight && ring?.width > 20 && ring.height > 20;
    });
    heads.push(await page.locator(".tour h2").innerText());
    await page.keyboard.press("Enter");
  }
  assert.equal(new Set(heads).size, 5 + 1);
  assert.equal(await page.locator(".tour, .tour-ring").count(), 0);
  await page.reload();
  await page.waitForFunction(() => window.teracell);
  await page.keyboard.press("?");
  await page.getByRole("dialog").waitFor();
  assert.equal(await page.getByRole("button", { name: "Show me" }).count(), 0);
  await close(page);
  const other = await open("g=graded");
  await other.keyboard.press("?");
  await other.getByRole("button", { name: "Show me" }).click();
  await other.getByText("1 of 6").waitFor();
  await other.waitForFunction(() => document.activeElement.closest(".tour"));
  await other.keyboard.press("Escape");
  await other.waitForFunction(() => !document.querySelector(".tour"));
  assert.equal(await other.evaluate(() => localStorage.getItem("teracell-tour")), "seen");
  await close(other);
});

for (const [name, width, height] of [["upright", 390, 844], ["on its side", 844, 390]])
  test(`a phone ${name} shows the whole width of the page, and views that can be used`, async () => {
    const page = await open("g=graded", { width, height });
    const { scroll, lowest } = await page.evaluate(() => ({
      scroll: document.documentElement.scrollWidth,
      lowest: Math.min(...[...document.querySelectorAll(".view-panel:not([hidden]) > .view-body")].map((body) => body.clientHeight)),
    }));
    assert.ok(scroll <= width, `the page is ${scroll} pixels wide`);
    assert.ok(lowest >= 120, `a view is ${lowest} pixels high`);
    await screenshot(page, `phone-${width}`);
    await close(page);
  });

test("a phone has one view at a time, a panel that is pulled up from below, and nothing that is cut off or too small to touch", async () => {
  const page = await open("g=graded", { width: 360, height: 740, hasTouch: true, isMobile: true });
  const in_sight = () => page.evaluate(() => [...document.querySelectorAll(".view-panel:not([hidden])")].map((panel) => panel.dataset.view));
  assert.deepEqual([await in_sight(), await state(page, "panel")], [["z"], null]);
  // Tabs of the sheet scroll; all else is whole.
  const wrong = () =>
    page.evaluate(() =>
      [...document.querySelectorAll("button, input, select, summary")]
        .filter((e) => e.checkVisibility() && !e.closest(".overview-triad, [role=tablist]"))
        .map((e) => [e, e.getBoundingClientRect()])
        .filter(([, { width, height, left, right }]) => width < 39.5 || height < 39.5 || left < -0.5 || right > innerWidth + 0.5)
        .map(([e, { width, height, right }]) => `${e.getAttribute("aria-label") ?? e.innerText}: ${width} x ${height}, to ${right}`),
    );
  assert.deepEqual(await wrong(), []);
  for (const [tab, view] of [["Only the slice across x", "x"], ["Only the overview in 3D", "3d"]]) {
    await page.getByRole("button", { name: tab }).tap();
    assert.deepEqual(await in_sight(), [view]);
  }
  await page.waitForSelector('.overview[data-state="sharp"]');
  assert.deepEqual(await wrong(), []);
  // The head of the sheet is pulled up to where the finger is, and down to close it; a tap on a tab opens it as well.
  const height = () => page.locator("#side-panel").evaluate((e) => e.offsetHeight);
  const pull = async (to) => {
    const { x, y } = await page.locator("#side-panel .tabs").boundingBox();
    await page.mouse.move(x + 60, y + 20);
    await page.mouse.down();
    await page.mouse.move(x + 60, to + 20, { steps: 4 });
    await page.mouse.up();
  };
  const closed = await height();
  await pull(300);
  assert.equal(await state(page, "panel"), "materials");
  assert.ok(Math.abs((await height()) - 440) < 4);
  assert.deepEqual(await wrong(), []);
  await pull(700);
  await page.waitForFunction(() => teracell.viewer.panel.value === null);
  assert.equal(await height(), closed);
  await page.getByRole("tab", { name: "Report" }).tap();
  assert.equal(await state(page, "panel"), "report");
  // A link to all four views shows one of them.
  await page.evaluate(() => (location.hash = "#g=graded"));
  await page.waitForFunction(() => teracell.viewer.layout.value === "3d");
  await close(page);
});
