// What `teracell check` has found, on the page: a verdict, kinds, places to go to, walls.
import assert from "node:assert/strict";
import test from "node:test";
import { after } from "node:test";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { close, folder, open_page, screenshot, serve, server_and_browser, settled, state } from "./support.mjs";

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
  const cell = await page.evaluate((at) => at.map((x, d) => teracell.viewer.axes[d].cell_at(x)), thin[0].at);
  assert.deepEqual(await state(page, "cell"), cell);
  // The overview has flown to what the slices frame.
  await page.waitForFunction(() => teracell.viewer.orbit.value?.target.every((x, d) => Math.abs(x - teracell.viewer.centre.value[d]) < 1e-6));
  await page.waitForSelector('.overview[data-state="sharp"]');
  const markers = await state(page, "markers");
  assert.ok(markers.length > 0 && markers.length <= 24);
  await screenshot(page, "findings");
  await close(page);
});

test("what is gone to is isolated, which is said and kept in the link; all is shown again as it was, by a button or Escape", async () => {
  const page = await open_page(browser, `${checked.url}#g=checked&panel=report&material=3:112233:0.5:0`);
  await settled(page);
  const looks = await state(page, "looks");
  const finding = document.findings.find((f) => f.kind === "thin");
  await page.locator("summary", { hasText: "Thin walls" }).click();
  const asked = [];
  page.on("request", (request) => request.url().includes("/view.bin") && asked.push(new URL(request.url()).searchParams.get("labels")));
  await page.locator(".finding").first().getByRole("button", { name: /Go there/ }).click();
  const label = await page.evaluate((name) => teracell.viewer.info.materials.findIndex((m) => m.name === name), finding.bodies[0]);
  assert.deepEqual(await state(page, "isolated"), { labels: [label], box: finding.box });
  assert.ok((await page.locator(".isolated-note").textContent()).includes(`Isolated:${finding.bodies[0]}`));
  await page.waitForFunction(() => document.querySelector(".overview")?.dataset.state === "sharp");
  assert.ok(asked.includes(String(label)) && asked.some((labels) => labels && labels !== String(label)), `asked for ${asked}`);
  await page.waitForFunction((found) => location.hash.includes(`only=`) && location.hash.includes(`found=${found}`), finding.box.join(","));
  const other = await open_page(browser, page.url());
  await other.getByRole("button", { name: "Show all again" }).waitFor();
  assert.deepEqual(await state(other, "isolated"), { labels: [label], box: finding.box });
  await other.getByRole("button", { name: "Show all again" }).click();
  assert.equal(await state(other, "isolated"), null);
  await close(other);
  await page.keyboard.press("Escape");
  assert.equal(await state(page, "isolated"), null);
  assert.equal(await page.getByRole("button", { name: "Show all again" }).count(), 0);
  assert.deepEqual(await state(page, "looks"), looks);
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
