// What `teracell check` has found, on the page: a verdict, kinds, places to go to, walls.
import assert from "node:assert/strict";
import test from "node:test";
import { after } from "node:test";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { close, folder, open_page, screenshot, serve, server_and_browser, state } from "./support.mjs";

const { server, browser } = await server_and_browser();
const checked = await serve(join(folder, "checked"));
after(async () => assert.deepEqual(await checked.stop(), []));
const document = JSON.parse(readFileSync(join(folder, "checked", "checked.check.json"), "utf8"));

// Without what the page writes for people: thin spaces between thousands, true minus signs.
const plain = (text) => text.replace(/(?<=\d)[,\u202f](?=\d{3})/g, "").replaceAll("−", "-");

test("the verdict counts what was found; each kind has its findings, each finding a picture and a place to go to", async () => {
  const page = await open_page(browser, `${checked.url}#g=checked&panel=report`);
  const warnings = document.findings.filter((f) => f.level === "warning").length;
  await page.getByText(`${warnings} warnings: `).waitFor();
  const thin = document.findings.filter((f) => f.kind === "thin");
  const total = document.totals.thin.findings;
  const group = page.locator("summary", { hasText: "Thin walls" });
  assert.equal((await group.locator(".body-cells").textContent()).replace(/\D/g, ""), String(total));
  await group.click();
  const first = page.locator(".finding").first();
  assert.ok(plain(await first.textContent()).includes(plain(thin[0].text)));
  await first.locator("summary").click();
  await page.waitForFunction(() => document.querySelector(".finding-picture img")?.naturalWidth > 0);
  await page.waitForSelector('.overview[data-state="sharp"]');
  await first.getByRole("button", { name: /Go there/ }).click();
  await page.waitForFunction(() => teracell.viewer.visited.value !== null);
  const cell = await page.evaluate((at) => at.map((x, d) => teracell.viewer.axes[d].cell_at(x)), thin[0].at);
  assert.deepEqual(await state(page, "cell"), cell);
  await page.waitForFunction((at) => teracell.viewer.orbit.value?.target.every((x, d) => Math.abs(x - at[d]) < 1e-6), thin[0].at);
  await page.waitForSelector('.overview[data-state="sharp"]');
  const markers = await state(page, "markers");
  assert.ok(markers.length > 0 && markers.length <= 24);
  await screenshot(page, "findings");
  await close(page);
});

test("walls have their histograms, and the list can be about one body", async () => {
  const page = await open_page(browser, `${checked.url}#g=checked&panel=report`);
  await page.locator(".wall").first().waitFor();
  assert.equal(await page.locator(".wall").count(), document.walls.length);
  const wall = document.walls.find((w) => w.thinnest_cells !== null);
  const label = await page.locator(".wall", { hasText: wall.body }).locator(".histogram").getAttribute("aria-label");
  assert.ok(label.startsWith(`${String(wall.histogram[Math.floor(wall.thinnest_cells) - 1]).replace(/\B(?=(\d{3})+$)/g, "\u202f")} cell`), label);
  const body = document.findings.find((f) => f.kind === "cut").bodies[0];
  await page.getByLabel("The body whose findings are listed").selectOption(body);
  const kinds = new Set(document.findings.filter((f) => f.bodies.includes(body)).map((f) => f.kind));
  assert.equal(await page.locator(".bodies > .body summary .dot").count(), kinds.size);
  for (const text of document.not_looked_at) await page.getByText(text).waitFor();
  await close(page);
});

test("where nobody has looked, the page says what would", async () => {
  const page = await open_page(browser, `${server.url}#g=stadium&panel=report`);
  await page.getByText("teracell check stadium.tcell").waitFor();
  await close(page);
});
