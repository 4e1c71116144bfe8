// What `teracell check` has found, on the page: a verdict, kinds, places to go to, walls.
import assert from "node:assert/strict";
import test from "node:test";
import { after } from "node:test";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { close, folder, open_page, packed, pixels, screenshot, serve, server_and_browser, settled, state } from "./support.mjs";

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
  await page.getByLabel(/^Mark .* in the views: thin walls$/).waitFor();
  await screenshot(page, "findings");
  await page.getByRole("button", { name: "Side panel" }).click();
  await page.waitForFunction(() => teracell.viewer.markers.value.length === 0);
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
  assert.ok((await page.locator(".isolated-note").textContent()).includes(`Isolated: ${finding.bodies[0]}`));
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

test("the cells that two bodies have in common are drawn by themselves, in slices and in three dimensions, where the file keeps them apart", async () => {
  const page = await open_page(browser, `${checked.url}#g=overlap&panel=report`);
  await settled(page);
  await page.locator("summary", { hasText: "Overlaps" }).click();
  await page.locator(".finding", { hasText: "'block' and 'plate'" }).getByRole("button", { name: /Go there/ }).click();
  assert.equal(await page.locator(".isolated-note b").textContent(), "the overlap of block and plate");
  const common = [[20, 25], [15, 25], [10, 30]];
  await settled(page);
  for (const [axis, u, v, w] of [["z", 0, 1, 2], ["x", 1, 2, 0], ["y", 0, 2, 1]]) {
    const [centre, zoom, at] = [await state(page, "centre"), await state(page, "zoom"), await state(page, "cell")];
    assert.ok(common[w][0] <= at[w] && at[w] < common[w][1]);
    const { width, height, data } = await pixels(page, axis);
    const along = (pixel, size, d, sign) => centre[d] + (sign * (pixel + 0.5 - size / 2)) / zoom;
    const inside = (place, d) => Math.min(place - common[d][0], common[d][1] - place) * zoom; // pixels from the sides
    let seen = 0;
    for (let y = 0; y < height; ++y)
      for (let x = 0; x < width; ++x) {
        const off = Math.min(inside(along(x, width, u, 1), u), inside(along(y, height, v, -1), v));
        if (Math.abs(off) < 1.5) continue; // the pixel may hold both
        assert.equal(data[y * width + x] === packed(225, 29, 138), off > 0, `${axis} ${x} ${y}`);
        seen += Number(off > 0);
      }
    assert.ok(seen > 1000);
  }
  await page.waitForSelector('.overview[data-state="sharp"]');
  const [png, box] = [await screenshot(page, "overlap"), await page.locator(".overview").boundingBox()];
  let hue = 0;
  for (let y = Math.ceil(box.y); y < box.y + box.height; ++y)
    for (let x = Math.ceil(box.x); x < box.x + box.width; ++x) {
      const [r, g, b] = [0, 8, 16].map((shift) => (png.data[y * png.width + x] >> shift) & 255);
      hue += Number(r > 1.8 * g && b > 1.2 * g && r > b);
    }
  assert.ok(hue > 2000, `${hue} pixels have the hue of the overlap`);
  const other = await open_page(browser, page.url());
  await other.getByText("the overlap of block and plate").waitFor();
  assert.deepEqual(await state(other, "isolated"), await state(page, "isolated"));
  await close(other);
  await page.locator("#panel-tab-bodies, [role=tab]", { hasText: "Bodies" }).click();
  const titles = await page.locator(".materials .material-title").allTextContents();
  assert.equal(titles.length, 4, "what lies in other bodies is no item of its own");
  await close(page);
});

test("walls have their histograms, and the list can be about one body", async () => {
  const page = await open_page(browser, `${checked.url}#g=checked&panel=report`);
  await page.locator(".wall").first().waitFor();
  assert.equal(await page.locator(".wall").count(), document.walls.filter((w) => w.thinnest_cells !== null).length);
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
