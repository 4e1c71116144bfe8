// The start page: many grids are found, ordered and judged; pictures are fetched for what is in sight alone.
import assert from "node:assert/strict";
import test from "node:test";
import { after } from "node:test";
import { linkSync, mkdirSync } from "node:fs";
import { join } from "node:path";
import { close, folder, grid_file, open_page, screenshot, serve, server_and_browser } from "./support.mjs";

const { server, browser } = await server_and_browser();
const many = join(folder, "many");
mkdirSync(many);
for (let n = 1; n <= 30; ++n) {
  const path = join(many, `part ${n}.tcell`);
  linkSync(grid_file(n === 7 ? "stadium" : "graded"), path);
}
for (const end of ["tcell", "check.json"]) linkSync(join(folder, "checked", `checked.${end}`), join(many, `checked.${end}`));
const crowd = await serve(many);
after(async () => assert.deepEqual(await crowd.stop(), []));

const names = (page) => page.locator(".card h2").allTextContents();

test("grids are searched by name and put in order; the slash key leads to the search", async () => {
  const page = await open_page(browser, crowd.url);
  await page.getByRole("heading", { name: "31 grids" }).waitFor();
  assert.deepEqual((await names(page)).slice(0, 4), ["checked", "part 1", "part 2", "part 3"]);
  await page.getByLabel("Order of the grids").selectOption("cells");
  const cells = (await page.locator(".card-facts:first-of-type > :first-child").allTextContents())
    .slice(0, 3)
    .map((text) => text.split("×").reduce((all, n) => all * Number(n.replace(/\D/g, "")), 1));
  assert.ok(cells[0] >= cells[1] && cells[1] >= cells[2], cells.join());
  assert.deepEqual((await names(page)).slice(0, 2), ["checked", "part 7"]);
  await page.keyboard.press("/");
  await page.keyboard.type("ART 7");
  await page.waitForFunction(() => document.querySelectorAll(".card").length === 1);
  assert.deepEqual(await names(page), ["part 7"]);
  await page.keyboard.type("x");
  await page.getByText("No name contains this text.").waitFor();
  await page.keyboard.press("Backspace");
  await page.getByText("1 found.").waitFor();
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => window.teracell?.viewer.info.id === "part 7");
  await page.goto(`${crowd.url}?grid=part 8.tcell`);
  await page.waitForFunction(() => window.teracell?.viewer.info.id === "part 8");
  await close(page);
});

test("cards have pictures in three dimensions, which are fetched when they come into sight", async () => {
  const page = await open_page(browser, `${crowd.url}NOTICE`);
  const asked = new Set();
  page.on("request", (request) => /view\.png/.test(request.url()) && asked.add(decodeURIComponent(/grids\/([^/]+)/.exec(request.url())[1])));
  await page.goto(crowd.url);
  await page.waitForFunction(() => document.querySelector(".preview-3d img")?.naturalWidth > 0);
  await page.waitForFunction(() => document.querySelectorAll(".preview-3d img").length >= 4);
  assert.ok(asked.size < 20, `${asked.size} of 31 grids were asked for their picture`);
  assert.ok(!asked.has("part 30"));
  await page.getByRole("heading", { name: "part 30" }).scrollIntoViewIfNeeded();
  await page.waitForFunction(() => document.querySelector('img[alt="part 30 in three dimensions"]')?.naturalWidth > 0);
  await page.evaluate(() => scrollTo(0, 0));
  await screenshot(page, "start-many");
  await close(page);
});

test("each card says what is wrong, or that nobody has looked", async () => {
  const page = await open_page(browser, crowd.url);
  const card = (name) => page.locator(".card", { has: page.getByRole("heading", { name, exact: true }) });
  await card("checked").getByText(/warnings/).waitFor();
  await card("part 1").getByText("Not checked yet").waitFor();
  await close(page);
  const open = await open_page(browser, server.url);
  await open.getByText(/is open|owns no cell/).first().waitFor();
  await close(open);
});
