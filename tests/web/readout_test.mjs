// The page's numbers are those of `teracell column`, `stats` and `export`.
import assert from "node:assert/strict";
import test from "node:test";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import {
  close, column_of, decoded_png, exported_cell, folder, info_of, offset_in, open_grid, packed, point_of, server_and_browser, settled, state, stats_of,
  view,
} from "./support.mjs";

const { server, browser } = await server_and_browser();

const open = (grid, rest = "", options = {}) => open_grid(browser, `${server.url}#g=${grid}${rest}`, options);
const digits = (text) => Number(text.replace(/[^\d.−-]/g, "").replace("−", "-"));

for (const grid of ["stadium", "graded"])
  test(`${grid}: the read-out under the pointer shows the cell's indices, its coordinates, and the material that \`export\` gives`, async () => {
    const page = await open(grid);
    const { materials, grid: g } = info_of(grid);
    const part = page.getByRole("region", { name: "Under the pointer" });
    let seen = new Set();
    for (const axis of ["x", "y", "z"])
      for (const [dx, dy] of [[0, 0], [13, -5], [-80, 9], [55, 20], [-120, -12], [31, 40], [95, 33]]) {
        const point = await point_of(page, axis, dx, dy);
        const [right, down] = await offset_in(page, axis, point);
        await page.mouse.move(...point);
        await settled(page);
        const hover = await page.evaluate(() => teracell.viewer.hover.value);
        if (!hover) continue; // outside the grid
        assert.equal(hover.axis, "xyz".indexOf(axis));
        const { zoom, centre, cell } = await page.evaluate(() => ({
          zoom: teracell.viewer.zoom.value, centre: teracell.viewer.centre.value, cell: teracell.viewer.cell.value,
        }));
        const [u, v, w] = [[1, 2, 0], [0, 2, 1], [0, 1, 2]][hover.axis];
        assert.equal(hover.cell[w], cell[w]);
        for (const [d, expected] of [[u, centre[u] + right / zoom], [v, centre[v] - down / zoom]]) {
          assert.ok(Math.abs(hover.point[d] - expected) < 0.01 / zoom, `coordinate ${hover.point[d]}, expected ${expected}`);
          const a = g.axes[d];
          const plane = (i) => (a.type === "graded" ? a.planes[i] : a.min + (a.first + i) * a.step);
          assert.ok(plane(hover.cell[d]) <= hover.point[d] && hover.point[d] < plane(hover.cell[d] + 1));
        }
        const material = exported_cell(grid, hover.cell);
        // Coarse views know only the set of materials. It must contain the material of the cell.
        assert.ok(hover.labels.includes(material), `${hover.labels} at ${hover.cell}, expected ${material}`);
        seen.add(material);
        const text = await part.innerText();
        assert.ok(text.includes(materials[material].name), text);
        assert.equal(text.includes("mixed:"), hover.labels.length > 1, text);
        for (const [d, row] of (await part.getByRole("row").all()).entries())
          assert.equal(digits(await row.getByRole("cell").first().innerText()), hover.cell[d]);
      }
    assert.ok(seen.size >= 2, "the pointer met only one material");
    await close(page);
  });

for (const grid of ["stadium", "graded"])
  test(`${grid}: a click pins the cell, and its three columns, copied as CSV, are those of \`column\``, async () => {
    const page = await open(grid, "", { permissions: ["clipboard-read", "clipboard-write"] });
    await page.mouse.click(...(await point_of(page, "z", 20, 10)));
    const cell = await state(page, "pinned");
    assert.deepEqual(cell, await state(page, "cell"));
    const pinned = page.getByRole("region", { name: "Pinned cell" });
    await page.waitForFunction(
      (name) => document.querySelector(`[aria-label="Pinned cell"] .dock-material`).innerText.includes(name),
      info_of(grid).materials[exported_cell(grid, cell)].name,
    );
    for (const [d, row] of (await pinned.getByRole("row").all()).entries())
      assert.equal(digits(await row.getByRole("cell").first().innerText()), cell[d]);
    await page.getByRole("button", { name: "Copy the runs of the three columns as CSV" }).click();
    const csv = (await page.evaluate(() => navigator.clipboard.readText())).trim().split("\n").slice(1).map((line) => line.split(","));
    const expected = ["x", "y", "z"].flatMap((axis) => {
      const others = [[1, 2], [0, 2], [0, 1]]["xyz".indexOf(axis)];
      return column_of(
        grid,
        axis,
        others.map((d) => cell[d]),
      ).runs.map((r) => [axis, r.from, r.to, r.min, r.max, r.max - r.min, r.material, r.name].map(String));
    });
    assert.deepEqual(csv, expected);
    // The pin stays when the pointer and the slice move on. The button removes it.
    await page.mouse.move(...(await point_of(page, "y")));
    await page.keyboard.press(".");
    assert.deepEqual(await state(page, "pinned"), cell);
    await page.getByRole("button", { name: "Unpin the cell" }).click();
    assert.equal(await state(page, "pinned"), null);
    await close(page);
  });

// Checks that every view shows the whole of a box of the stadium's cells, as large as possible.
async function expect_all_of(page, box) {
  await settled(page);
  const { axes } = info_of("stadium").grid;
  const [centre, zoom] = [await state(page, "centre"), await state(page, "zoom")];
  const away = (d) => Math.max(...[box[d], box[d + 3]].map((i) => Math.abs(axes[d].min + (axes[d].first + i) * axes[d].step - centre[d]))) * zoom;
  const reaches = [];
  for (const [axis, u, v] of [["x", 1, 2], ["y", 0, 2], ["z", 0, 1]]) {
    const { width, height } = await view(page, axis).boundingBox();
    reaches.push(away(u) / (width / 2), away(v) / (height / 2));
  }
  const most = Math.max(...reaches);
  assert.ok(most > 0.5 && most < 0.9, `the box reaches ${most} of the way to a view's edge`);
}

test("the materials' cells, volumes and boxes are those of `stats`", async () => {
  const page = await open("stadium");
  const expected = stats_of("stadium").materials;
  await page.waitForFunction(() => !document.querySelector(".materials").innerText.includes("…"));
  const cards = await page.locator("li.material").all();
  assert.equal(cards.length, expected.length);
  for (const [id, card] of cards.entries()) {
    const [cells, volume] = await card.getByRole("definition").allInnerTexts();
    assert.equal(digits(cells.split(/\s{1,}(?=[<\d.]+\s*%)/)[0]), expected[id].cells, cells);
    assert.ok(Math.abs(digits(volume.replace("m³", "")) / expected[id].volume - 1) < 1e-4, volume);
  }
  // "Go there" looks at the box of the second material.
  const card = page.locator("li.material").nth(1);
  await card.getByText("Bounding box").click();
  const name = info_of("stadium").materials[1].name;
  await card.getByRole("button", { name: `Go there: ${name}` }).click();
  await settled(page);
  const { box } = expected[1];
  const cell = await state(page, "cell");
  cell.forEach((i, d) => assert.ok(i >= box[d] && i < box[d + 3], `${cell} is not in ${box}`));
  await expect_all_of(page, box);
  // A box as high as it is wide, in views that are wider than high.
  const { cells } = info_of("stadium").grid;
  const square = [0, 0, 0, cells[1], cells[1], cells[2]];
  await page.evaluate((to) => teracell.viewer.go_to_box(to), square);
  await expect_all_of(page, square);
  await close(page);
});

test("the statistics of a box that is drawn are exact", async () => {
  const page = await open("stadium");
  await page.mouse.move(...(await point_of(page, "z")));
  await page.keyboard.press("x");
  await page.mouse.move(...(await point_of(page, "z", -60, -40)));
  await page.mouse.down();
  await page.mouse.move(...(await point_of(page, "z", 70, 30)), { steps: 4 });
  await page.mouse.up();
  assert.equal(await state(page, "tool"), "look", "a tool draws only once");
  const box = await state(page, "box");
  const { cells } = info_of("stadium").grid;
  assert.deepEqual([box[2], box[5]], [0, cells[2]]);
  for (const d of [0, 1]) assert.ok(box[d] > 0 && box[d] < box[d + 3] && box[d + 3] < cells[d], String(box));
  await page.waitForSelector('table.stats[aria-busy="false"]');
  const rows = await page.locator("table.stats tbody tr").all();
  const expected = stats_of("stadium", box).materials.filter((m) => m.cells > 0);
  assert.equal(rows.length, expected.length);
  for (const [n, row] of rows.entries()) {
    assert.equal((await row.getByRole("rowheader").innerText()).trim(), expected[n].name);
    assert.equal(digits(await row.getByRole("cell").first().innerText()), expected[n].cells);
  }
  // The box survives a click, and a click with the tool.
  await page.mouse.click(...(await point_of(page, "z", 100, 60)));
  await page.keyboard.press("x");
  await page.getByText("Drag a box in a slice").waitFor();
  await page.mouse.click(...(await point_of(page, "z", 20, 60)));
  assert.equal(await state(page, "tool"), "box");
  await page.keyboard.press("Escape");
  assert.equal(await state(page, "tool"), "look");
  assert.deepEqual(await state(page, "box"), box);
  await close(page);
});

test("a distance is measured in units of length", async () => {
  const page = await open("graded");
  const zoom = await state(page, "zoom");
  await page.mouse.move(...(await point_of(page, "z")));
  await page.keyboard.press("m");
  await page.mouse.move(...(await point_of(page, "z", -30, 40)));
  await page.mouse.down();
  await page.mouse.move(...(await point_of(page, "z", 30, -40)), { steps: 4 });
  await page.mouse.up();
  const measure = await state(page, "measure");
  const { axis, from, to } = measure;
  assert.equal(axis, 2);
  assert.ok(Math.abs(Math.hypot(...from.map((x, d) => to[d] - x)) - 100 / zoom) < 2 / zoom);
  await page.keyboard.press("m");
  await page.mouse.click(...(await point_of(page, "z", 10, 40)));
  assert.deepEqual(await state(page, "measure"), measure, "a press without a movement draws nothing");
  await page.keyboard.press("Escape");
  assert.equal(await state(page, "tool"), "look");
  await page.getByRole("tab", { name: "Box" }).click();
  const said = page.getByRole("definition").first();
  assert.ok(Math.abs(digits((await said.innerText()).replace("mm", "")) - 100 / zoom) < 2 / zoom, await said.innerText());
  await close(page);
});

test("the report says how many cells of each body stronger bodies own", async () => {
  const page = await open("stadium", "&panel=report");
  const overlapping = info_of("stadium").report.bodies.filter((b) => b.covered_cells);
  assert.ok(overlapping.length > 2);
  const { name, covered_cells } = overlapping[0];
  const body = page.locator(".body").filter({ hasText: name });
  if ((await body.getAttribute("open")) === null) await body.locator("summary").click();
  const said = await body.getByRole("definition").filter({ hasText: "owned by stronger bodies" }).innerText();
  assert.equal(digits(said), covered_cells);
  await close(page);
});

test("the report names a hole, marks it and leads to it, and it names a body without cells", async () => {
  const page = await open("open");
  const report = info_of("open").report;
  await page.getByRole("tab", { name: "Report" }).click();
  const panel = page.getByRole("tabpanel");
  const { holes } = report.bodies.find((b) => b.name === "tin");
  assert.equal(holes.length, 1);
  const text = await panel.innerText();
  assert.match(text, /no cells/);
  assert.match(text, /4 edges/);
  await page.waitForFunction(() => teracell.viewer.markers.value.length === 1);
  await panel.getByRole("button", { name: /Go there: the hole/ }).click();
  await settled(page);
  const { axes } = info_of("open").grid;
  const expected = holes[0].at.map((x, d) => Math.floor((x - axes[d].min) / axes[d].step));
  assert.deepEqual(await state(page, "cell"), expected);
  await page.screenshot({ path: `${process.env.TERACELL_FOLDER}/report.png` });
  await close(page);
});

// Opens the page with changed information and statistics about the stadium.
async function open_told(t, { info = (j) => j, stats = (j) => j, place = "" }) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 } });
  t.after(async () => {
    await context.unrouteAll({ behavior: "wait" });
    await context.close();
  });
  const answer = (change) => async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, json: change(await response.json()) });
  };
  await context.route(/\/api\/v1\/grids\/stadium(\?v=\w+)?$/, answer(info));
  await context.route(/\/api\/v1\/grids\/stadium\/stats/, answer(stats));
  return open_grid(browser, `${server.url}#g=stadium&layout=z${place}`, { context });
}

test("very many materials have one line each, which can be opened; the rest is found by a click or by name", async (t) => {
  const COUNT = 65535;
  const grown = (list, more) => Array.from({ length: COUNT }, (_, id) => list[id] ?? { ...more, id, name: `m${id}` });
  const page = await open_told(t, {
    info: (j) => ({ ...j, materials: grown(j.materials, { color: "#123456", rank: 1 }) }),
    stats: (j) => ({ ...j, materials: grown(j.materials, { cells: 0, volume: 0, box: null }) }),
    place: "&at=60,40,12", // the server has less to look for
  });
  const cards = page.locator(".material");
  assert.equal(await cards.count(), 100);
  const filter = page.getByRole("searchbox");
  assert.ok((await filter.boundingBox()).height >= 26, "the filter is squashed");
  for (const n of [0, 50]) assert.ok((await cards.nth(n).boundingBox()).height < 36, "a card is not one line");
  const { name } = info_of("stadium").materials[2];
  const title = page.getByRole("button", { name: new RegExp(`^${name}`) });
  const card = cards.filter({ has: title });
  assert.equal(await card.getByRole("slider").count(), 0);
  await title.click();
  await card.getByRole("slider", { name: `Opacity of ${name}` }).waitFor();
  await card.getByText("Bounding box").waitFor();
  await page.screenshot({ path: join(folder, "many-materials.png") });
  await page.getByRole("button", { name: /435 more/ }).click();
  await page.waitForFunction(() => document.querySelectorAll(".material").length === 200);
  await filter.fill("m65000");
  await page.waitForFunction(() => document.querySelectorAll(".material").length === 1);
  await page.getByRole("button", { name: "Show m65000" }).click();
  assert.equal(await page.evaluate(() => teracell.viewer.looks.value[65000].visible), false);
  await page.waitForFunction(() => location.hash.includes("material=65000:"));
  assert.deepEqual(page.errors, []);
});

test("of very many bodies, holes and warnings the first are shown, and a click shows more", async (t) => {
  const page = await open_told(t, {
    info: (j) => {
      const body = (n) => ({ ...j.report.bodies[0], name: `body ${n}`, cells: n === 4999 ? 1 : 2, holes: [] });
      const bodies = Array.from({ length: 5000 }, (_, n) => body(n));
      bodies[7].holes = Array.from({ length: 10000 }, (_, n) => ({ at: [0, 0, 0], edges: 3, diameter: 1 + n, diameter_cells: 10, cap_area: 1 }));
      return { ...j, report: { ...j.report, bodies, overlaps: undefined, warnings: bodies.map((b) => `body '${b.name}' is open`) } };
    },
  });
  await page.getByRole("tab", { name: "Report" }).click();
  const bodies = page.locator(".body");
  await bodies.first().waitFor();
  assert.equal(await bodies.count(), 100);
  assert.match(await bodies.first().innerText(), /body 7\n10\s000 holes/);
  assert.equal(await bodies.first().locator(".places li:not(.more)").count(), 30);
  assert.equal(await page.locator(".warnings li:not(.more)").count(), 100);
  assert.equal(await page.locator(".body-details").count(), 1); // those of the body that is open
  await bodies.nth(1).locator("summary").click();
  await bodies.nth(1).getByText("facets").first().waitFor();
  await page.locator(".bodies").getByRole("button", { name: /4\s900 more/ }).click();
  await page.waitForFunction(() => document.querySelectorAll(".body").length === 200);
  await page.screenshot({ path: join(folder, "many-bodies.png") });
  await page.waitForFunction(() => location.hash.includes("marks=1"));
  assert.deepEqual(page.errors, []);
});

async function saved_picture(page, name) {
  await page.getByRole("tab", { name: "Link" }).click();
  const downloading = page.waitForEvent("download");
  await page.getByRole("button", { name: "Save as PNG" }).click();
  const download = await downloading;
  const path = `${process.env.TERACELL_FOLDER}/${name}.png`;
  await download.saveAs(path);
  assert.match(download.suggestedFilename(), /stadium.*\.png$/);
  return decoded_png(readFileSync(path));
}

test("the view is saved as a PNG with a legend", async () => {
  const page = await open("stadium", "&layout=z");
  const picture = await saved_picture(page, "saved");
  const box = await view(page, "z").boundingBox();
  assert.ok(picture.width >= box.width && picture.height >= box.height);
  const there = new Set(picture.data);
  for (const { color } of info_of("stadium").materials.slice(1)) {
    const [r, g, b] = [1, 3, 5].map((at) => Number.parseInt(color.slice(at, at + 2), 16));
    assert.ok(there.has(packed(r, g, b)), `${color} is neither in the picture nor in the legend`);
  }
  await close(page);
});

test("four views are saved completely: crosshairs from edge to edge, and the overview with its ground, rulers and triad", async () => {
  const page = await open("stadium");
  await page.waitForSelector('.overview[data-state="sharp"]');
  const picture = await saved_picture(page, "saved-four");
  const boxes = await page.evaluate(() => {
    const { left, top } = document.querySelector(".views").getBoundingClientRect();
    const box = (panel) => panel.getBoundingClientRect();
    return Object.fromEntries(
      [...document.querySelectorAll(".view-panel")].map((p) => [p.dataset.view, [box(p).left - left, box(p).top - top, box(p).width, box(p).height]]),
    );
  });
  const [ratio, head] = [2, 44];
  // The pixels of a part of a panel, in CSS pixels.
  const part = (view, x0, y0, width, height) => {
    const [left, top] = [Math.round(ratio * (boxes[view][0] + x0)), Math.round(ratio * (boxes[view][1] + y0 + head))];
    return Array.from({ length: ratio * height }, (_, y) => [
      ...picture.data.subarray((top + y) * picture.width + left, (top + y) * picture.width + left + ratio * Math.floor(width)),
    ]).flat();
  };
  const inks = { x: packed(0xc8, 0x10, 0x2e), y: packed(0x0b, 0x7a, 0x34), z: packed(0x1f, 0x4f, 0xe0) }; // base.css
  for (const [axis, vertical] of [["x", "y"], ["y", "x"], ["z", "x"]]) {
    const [, , width, height] = boxes[axis];
    // At the lower edge, the number and the tick of a ruler may cover the line, but not the place between them.
    for (const y of [0, height - 8])
      assert.ok(part(axis, 0, y, width, 1).includes(inks[vertical]), `the crosshair ends before ${y} of ${height} in the view across ${axis}`);
  }
  const [, , width, height] = boxes["3d"];
  const triad = part("3d", 8, height - 90, 80, 80);
  for (const ink of Object.values(inks)) assert.ok(triad.filter((pixel) => pixel === ink).length > 100, "there is no triad");
  assert.notEqual(part("3d", width / 2, 60, 1, 1)[0], part("3d", 2, height - 3, 1, 1)[0], "the ground has one colour");
  await close(page);
});
