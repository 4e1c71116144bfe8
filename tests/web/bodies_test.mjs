// Grids that keep bodies apart: bodies are hidden, shown alone, coloured and picked, in the slices and in three dimensions.
import assert from "node:assert/strict";
import test from "node:test";
import { after } from "node:test";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { close, folder, open_grid, packed, pixels, screenshot, serve, server_and_browser, settled, shares, state, view } from "./support.mjs";

const { server, browser } = await server_and_browser();
const apart = await serve(join(folder, "bodies"));
after(async () => assert.deepEqual(await apart.stop(), []));
const file = join(folder, "bodies", "bodies.tcell");
const told = (...args) => JSON.parse(execFileSync(process.env.TERACELL, [args[0], file, ...args.slice(1), "--json"], { maxBuffer: 1 << 28 }));
const { labels, materials } = told("info");
const { bodies } = told("stats", "--bodies");
const label_of = (name) => labels.findIndex(({ body }) => body === name);
const sharp = (page) => page.waitForSelector('.overview[data-state="sharp"]');
const row = (page, name) => page.locator(".material", { has: page.locator(".material-title", { hasText: new RegExp(`^${name} `) }) });

// What the sharp picture of the 3D view shows, as colours and their shares.
async function colors_in_3d(page) {
  await sharp(page);
  return shares((await screenshot(page, "bodies-3d")).data);
}

test("each body is listed with its cells, and what is hidden is hidden everywhere", async () => {
  const page = await open_grid(browser, `${apart.url}#g=bodies&panel=bodies`);
  await page.getByPlaceholder("Filter 10 bodies").waitFor();
  for (const { label, name, cells } of bodies.filter(({ name }) => name)) {
    await row(page, name).locator("button.material-title").click();
    await row(page, name).getByText("Bounding box").waitFor();
    const text = await row(page, name).textContent();
    assert.ok(text.includes(materials[labels[label].material].name), `${name}: its material is missing in ${text}`);
    assert.ok(text.replace(/\s/g, "").includes(String(cells)), `${name}: ${cells} cells are missing in ${text}`);
  }
  const roof = label_of("roof");
  await row(page, "roof").getByText("Bounding box").click();
  await row(page, "roof").getByRole("button", { name: "Go there: roof" }).click();
  await settled(page);
  const boxes = [];
  for (const axis of "xyz") boxes.push(await view(page, axis).boundingBox());
  const in_sight = await page.evaluate((boxes) => {
    const seen = new Set();
    for (const [d, box] of boxes.entries())
      for (let x = 4; x < box.width; x += 7) for (let y = 4; y < box.height; y += 7) for (const label of teracell.label_at(d, box.x + x, box.y + y) ?? []) seen.add(label);
    return [...seen];
  }, boxes);
  assert.ok(in_sight.includes(roof), "no slice is through the roof");
  const before = await colors_in_3d(page);
  await row(page, "roof").getByRole("button", { name: "Show roof" }).click();
  assert.equal(await page.evaluate((l) => teracell.viewer.label_looks.value[l].visible, roof), false);
  await settled(page);
  const after_hiding = await colors_in_3d(page);
  assert.notDeepEqual(after_hiding, before);
  await page.waitForFunction((l) => location.hash.includes(`hidden=${l}`), roof);
  await close(page);
});

test("the list is filtered and ordered, and what is found is hidden or shown alone", async () => {
  const page = await open_grid(browser, `${apart.url}#g=bodies&panel=bodies`);
  const titles = () => page.locator(".materials .material-title").allTextContents();
  await page.getByLabel("Order of the bodies").selectOption("most");
  const counted = [...bodies].sort((a, b) => b.cells - a.cells).map(({ name, material }) => name || materials[material].name);
  await page.waitForFunction((names) => names.every((name, n) => document.querySelectorAll(".materials .material-title")[n]?.textContent.startsWith(name)), counted);
  assert.deepEqual((await titles()).map((title, n) => title.startsWith(counted[n])), counted.map(() => true));
  await page.getByLabel("Filter bodies by name").fill("TIER");
  const tiers = labels.flatMap(({ body }, label) => (body.includes("tier") ? [label] : []));
  await page.getByRole("button", { name: `Show only these ${tiers.length}` }).click();
  const visible = () => page.evaluate(() => teracell.viewer.label_looks.value.flatMap((look, label) => (look.visible ? [label] : [])));
  assert.deepEqual(await visible(), tiers);
  await page.getByRole("button", { name: "Hide these" }).click();
  assert.deepEqual(await visible(), []);
  await close(page);
});

test("a body has a colour of its own, in the pixels of the slices too, and a link keeps it", async () => {
  const ground = label_of("ground");
  const page = await open_grid(browser, `${apart.url}#g=bodies&panel=bodies&body=${ground}:ff00ff:1&hidden=${labels.map((_, l) => l).filter((l) => l !== ground).join(",")}&layout=x`);
  await settled(page);
  const found = shares((await pixels(page, "x")).data);
  const pure = found.get(packed(255, 0, 255));
  assert.ok(pure > 0.01, `the ground has ${pure} of the pixels`);
  assert.equal(await page.locator('.material-head [aria-label="Only ground"]').getAttribute("aria-pressed"), "true");
  await page.getByRole("button", { name: "Show all" }).click();
  await settled(page);
  assert.ok(shares((await pixels(page, "x")).data).size > found.size);
  await page.getByRole("button", { name: "Reset" }).click();
  await settled(page);
  assert.equal(shares((await pixels(page, "x")).data).get(packed(255, 0, 255)), undefined);
  await close(page);
});

test("a click picks a body: its name, its cells and what can be done with it are there", async () => {
  const truck = bodies[label_of("truck")];
  const [x0, y0, z0, x1, y1, z1] = truck.box;
  const at = [(x0 + x1) >> 1, (y0 + y1) >> 1, (z0 + z1) >> 1];
  const page = await open_grid(browser, `${apart.url}#g=bodies&panel=bodies&pin=${at.join(",")}&at=${at.join(",")}`);
  const picked = page.getByRole("region", { name: "The body of the pinned cell" });
  await picked.waitFor();
  const cell = told("column", "--axis", "z", "--at", at.slice(0, 2).join(",")).runs.find((run) => run.from <= at[2] && at[2] < run.to);
  assert.ok((await picked.textContent()).includes(cell.name));
  const name = await picked.locator(".material-title").first().textContent();
  await picked.getByRole("button", { name: /^Only / }).click();
  const visible = await page.evaluate(() => teracell.viewer.label_looks.value.flatMap((look, label) => (look.visible ? [label] : [])));
  assert.equal(visible.length, 1);
  assert.ok(name.startsWith(labels[visible[0]].body || materials[0].name));
  await screenshot(page, "bodies");
  await close(page);
});

test("bodies named by their paths are a tree, of which a branch is hidden, shown alone and coloured at once", async () => {
  const page = await open_grid(browser, `${apart.url}#g=assembly&panel=bodies`);
  await page.getByText("wheel#2").waitFor();
  const titles = await page.locator(".materials .material-title bdi").allTextContents();
  assert.deepEqual(titles, ["air", "car", "front", "wheel", "wheel#2", "рама", "road"]);
  const looks = () => page.evaluate(() => teracell.viewer.label_looks.value.map(({ visible, color }) => (visible ? color.join() : "hidden")));
  const [air, steel, ...others] = await looks();
  await page.getByRole("button", { name: "Show /car/front", exact: true }).click();
  assert.deepEqual(await looks(), [air, "hidden", "hidden", ...others.slice(1)]);
  await page.getByRole("button", { name: "Only /car", exact: true }).click();
  assert.deepEqual(await looks(), ["hidden", steel, steel, steel, "hidden"]);
  await page.getByLabel("Colour of /car/front", { exact: true }).fill("#ff0010");
  assert.deepEqual(await looks(), ["hidden", "255,0,16", "255,0,16", steel, "hidden"]);
  await page.getByRole("button", { name: "Go there: /car/front", exact: true }).click();
  await page.waitForFunction(() => teracell.viewer.isolated.value?.labels.join() === "1,2");
  // The two wheels lie apart, so the middle of their box is in neither.
  const body_at = async ([i, j, k]) => (await (await fetch(`${apart.url}api/v1/grids/assembly/cell?i=${i}&j=${j}&k=${k}`)).json()).bodies[0].label;
  let there = 0;
  for (let n = 0; n < 100 && ![1, 2].includes(there); ++n) {
    await page.waitForTimeout(50);
    there = await body_at(await state(page, "cell"));
  }
  assert.ok([1, 2].includes(there), `the crosshair is in label ${there}`);
  assert.deepEqual(await looks(), ["hidden", "255,0,16", "255,0,16", steel, "hidden"], "what was chosen is as it was");
  await page.getByRole("button", { name: "Show all again" }).click();
  await screenshot(page, "bodies-tree");
  await page.getByRole("button", { name: "car", exact: false, expanded: true }).first().click();
  assert.equal(await page.getByText("wheel#2").count(), 0);
  await close(page);
});

test("a grid that keeps materials alone has no such list, and says how it would have one", async () => {
  const page = await open_grid(browser, `${server.url}#g=stadium&panel=bodies`);
  assert.equal(await page.getByRole("tab", { name: "Bodies" }).count(), 0);
  assert.equal(await state(page, "panel"), "materials");
  await page.getByText('"label_by": "body"').waitFor();
  await page.getByTitle("Hide grandstand: lower tier, upper tier").waitFor();
  await close(page);
});
