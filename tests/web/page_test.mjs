// The page as a whole: addresses, several grids or none, other paths, a token, a server that goes away and comes back, damaged
// files, themes, small windows, the keyboard alone.
import assert from "node:assert/strict";
import { createServer, request as http_request } from "node:http";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import {
  close, decoded_png, folder, grid_file, grids, info_of, open_grid, open_page, packed, pixels, point_of, quiet, screenshot, serve, server_and_browser,
  set_state, settled, shares, state, view,
} from "./support.mjs";

const { server, browser } = await server_and_browser();

const all_pixels = async (page) => Promise.all(["x", "y", "z"].map((axis) => pixels(page, axis)));

test("a link shows the same picture to everybody who opens it", async () => {
  const page = await open_grid(browser, `${server.url}#g=stadium`);
  await page.mouse.click(...(await point_of(page, "z", 33, -21)));
  await page.mouse.move(...(await point_of(page, "z", -20, 10)));
  await page.keyboard.down("Control");
  for (let n = 0; n < 4; ++n) await page.mouse.wheel(0, -100);
  await page.keyboard.up("Control");
  await page.mouse.wheel(0, 100);
  await page.getByRole("button", { name: `Show ${info_of("stadium").materials[3].name}` }).click();
  await page.keyboard.press("e");
  await settled(page);
  await page.waitForFunction(() => location.hash.includes("outline=1")); // the address follows after a moment
  const address = page.url();
  const names = ["cell", "centre", "zoom", "pinned", "show_outline", "looks"];
  const before = { pixels: await all_pixels(page), state: await Promise.all(names.map((n) => state(page, n))) };
  await close(page);
  const other = await open_grid(browser, address);
  assert.deepEqual(await Promise.all(names.map((n) => state(other, n))), before.state);
  const pictures = await all_pixels(other);
  pictures.forEach((picture, i) => assert.ok(picture.data.every((pixel, at) => pixel === before.pixels[i].data[at]), "another picture"));
  await close(other);
});

test("several grids: a start page; each opens, and the browser's back button leads back", async () => {
  const page = await open_page(browser, server.url);
  await page.getByRole("heading", { name: "3 grids" }).waitFor();
  for (const name of ["stadium", "graded", "open"]) await page.getByRole("heading", { name, exact: true }).waitFor();
  await page.waitForFunction(() => document.querySelectorAll(".preview canvas:not([hidden])").length === 9);
  await screenshot(page, "start-page");
  // 100 x 60 mm in 130 x 60 cells. The first 113 cells, which end at 49 mm, are steel.
  const graded = page.getByRole("img", { name: "graded: slice across z in the middle" });
  const { width, height, steel } = await graded.evaluate((canvas) => {
    const { width, height } = canvas;
    const row = canvas.getContext("2d").getImageData(0, 4, width, 1).data;
    return { width, height, steel: row.filter((alpha, at) => at % 4 === 3 && alpha > 0).length };
  });
  assert.ok(Math.abs(width / height - 100 / 60) < 0.02, `${width} x ${height}`);
  assert.ok(Math.abs(steel - 0.49 * width) <= 1, `${steel} of ${width} pixels are steel`);
  await page.getByRole("link", { name: /graded/ }).click();
  await settled(page);
  assert.equal(await page.evaluate(() => teracell.viewer.info.id), "graded");
  await page.goBack();
  await page.getByRole("heading", { name: "3 grids" }).waitFor();
  await page.getByRole("link", { name: /stadium/ }).click();
  await settled(page);
  assert.equal(await page.evaluate(() => teracell.viewer.info.id), "stadium");
  await close(page);
});

test("a step back just after a view changed leads back, also when the page hears of it late", async () => {
  const context = await browser.newContext();
  // As in a busy browser, which is at the earlier address some time before it says so.
  await context.addInitScript(() =>
    addEventListener("hashchange", (event) => {
      if (!event.isTrusted) return;
      event.stopImmediatePropagation();
      setTimeout(() => dispatchEvent(new HashChangeEvent("hashchange")), 500);
    }),
  );
  const page = await open_page(browser, server.url, { context });
  await page.getByRole("link", { name: /graded/ }).click();
  await settled(page);
  await set_state(page, { show_outline: true }); // it is written into the address after a moment
  await page.goBack();
  await page.getByRole("heading", { name: "3 grids" }).waitFor({ timeout: 10_000 });
  assert.equal(page.url(), server.url);
  await close(page);
});

test("the start page lists the addresses for other programs that the server names", async () => {
  const context = await browser.newContext();
  let named;
  await context.route("**/api/v1/grids", async (route) => {
    const response = await route.fetch();
    const json = await response.json();
    for (const { id, protocols } of json.grids) protocols.push({ title: "a new protocol", path: `/new/${id}/all` });
    named = json.grids.find(({ id }) => id === "graded").protocols;
    await route.fulfill({ response, json });
  });
  const page = await open_page(browser, server.url, { context });
  const card = page.getByRole("listitem").filter({ has: page.getByRole("heading", { name: "graded" }) });
  await card.getByText("Addresses for other programs").click();
  const shown = await card
    .getByRole("row")
    .evaluateAll((rows) => rows.map((row) => [row.querySelector("th").innerText, row.querySelector("code").innerText]));
  const expected = [{ title: "JSON", path: "/api/v1/grids/graded" }, ...named].map(({ title, path }) => [title, server.url.slice(0, -1) + path]);
  assert.ok(expected.length >= 8);
  assert.deepEqual(shown, expected);
  await screenshot(page, "addresses");
  await close(page);
});

test("the address of a grid that is not there: the page says so, and shows the grids that are", async () => {
  const page = await open_page(browser, `${server.url}#g=nobody`, { expected: (url, status) => status === 404 && url.includes("nobody") });
  await page.getByRole("alert").waitFor();
  assert.match(await page.getByRole("alert").innerText(), /nobody/);
  await page.getByRole("heading", { name: "stadium" }).waitFor();
  await close(page);
});

test("a folder without grids: the page says what to do", async () => {
  const empty = await serve(join(folder, "empty"));
  const page = await open_page(browser, empty.url);
  await page.getByRole("heading", { name: "No grid here yet" }).waitFor();
  assert.match(await page.getByRole("main").innerText(), /teracell mesh/);
  await screenshot(page, "empty");
  await close(page);
  assert.deepEqual(await empty.stop(), []);
});

test("the start page names files that can't be read and says why, even when there is a grid beside them", async () => {
  const broken = join(folder, "broken");
  mkdirSync(broken);
  const whole = readFileSync(grid_file("graded"));
  writeFileSync(join(broken, "short.tcell"), whole.subarray(0, whole.length / 2));
  const served = await serve(broken);
  const listed = async () => (await fetch(`${served.url}api/v1/grids`)).json();
  const page = await open_page(browser, served.url, { expected: (url, status) => status === 500 && url.includes("whole") });
  await page.getByRole("heading", { name: "1 file that can't be read" }).waitFor();
  const card = page.getByRole("listitem").filter({ has: page.getByRole("heading", { name: "short" }) });
  assert.match(await card.innerText(), /This file can't be read: short\.tcell: \S+/);
  assert.equal(await page.getByText("No grid here yet").count(), 0);
  await screenshot(page, "unreadable");
  writeFileSync(join(broken, "whole.tcell"), whole);
  while ((await listed()).grids.length === 0); // the server looks twice per second
  await page.reload();
  await page.getByRole("heading", { name: "One grid, 1 file that can't be read" }).waitFor();
  await page.getByRole("button", { name: "1 file that can't be read" }).click();
  await page.waitForSelector(".card.unreadable:focus");
  await page.getByRole("link", { name: /whole/ }).click();
  await settled(page);
  // The file of the open grid breaks as well. The banner says why as soon as the page looks again.
  writeFileSync(join(broken, "whole.tcell"), whole.subarray(0, whole.length / 2));
  while ((await listed()).grids.length > 0);
  await page.evaluate(() => ["offline", "online"].forEach((what) => dispatchEvent(new Event(what))));
  await page.getByText(/“whole” is no longer served: whole\.tcell: /).waitFor();
  await page.getByRole("link", { name: "All grids" }).click();
  await page.getByRole("heading", { name: "2 files that can't be read" }).waitFor();
  await card.waitFor();
  await close(page);
  const told = await served.stop((line) => line.startsWith("teracell: ") || JSON.parse(line).status === 500);
  assert.deepEqual(told, []);
});

test("the page works below a path, behind a proxy that puts another path in front", async () => {
  const based = await serve(grids, "--base-path", "/base");
  const proxy = createServer((request, response) => {
    const asked = http_request(
      {
        port: based.port,
        path: request.url.replace(/^\/front\/way/, ""),
        method: request.method,
        headers: { ...request.headers, "x-forwarded-prefix": "/front/way" },
      },
      (answer) => {
        response.writeHead(answer.statusCode, answer.headers);
        answer.pipe(response);
      },
    );
    asked.on("error", () => response.destroy());
    response.on("close", () => asked.destroy());
    asked.end();
  });
  await new Promise((listening) => proxy.listen(0, "127.0.0.1", listening));
  const root = `http://127.0.0.1:${proxy.address().port}/front/way/base`;
  const asked = [];
  const page = await open_page(browser, root); // is redirected to root/
  page.on("request", (request) => asked.push(request.url()));
  await page.getByRole("link", { name: /stadium/ }).click();
  await settled(page);
  assert.ok(asked.some((url) => url.includes("/tile/")));
  for (const url of asked) assert.ok(url.startsWith(`${root}/`) || url.startsWith("blob:"), url);
  await page.getByRole("tab", { name: "Link" }).click();
  assert.ok((await page.getByRole("tabpanel").innerText()).includes(`${root}/zarr/stadium`));
  await close(page);
  proxy.close();
  assert.deepEqual(await based.stop(), []);
});

test("a server with a token gives out the page, which asks for the token and sends it", async () => {
  const file = join(folder, "token");
  writeFileSync(file, "open sesame".replace(" ", "-"), { mode: 0o600 });
  const guarded = await serve(grid_file("graded"), "--token-file", file);
  const page = await open_page(browser, guarded.url, { expected: (url, status) => status === 401 });
  const field = page.getByLabel("Access token");
  await field.waitFor();
  await screenshot(page, "token");
  await field.fill("wrong");
  await page.getByRole("button", { name: "Open" }).click();
  await page.getByText("The server refused this token.").waitFor();
  await field.fill("“open-sesame”");
  await page.getByText("This one contains U+201C").waitFor();
  assert.ok(await page.getByRole("button", { name: "Open" }).isDisabled());
  await field.fill(" open-sesame ");
  await page.getByRole("button", { name: "Open" }).click();
  await settled(page);
  await page.reload();
  await settled(page); // this tab knows the token
  await page.getByRole("tab", { name: "Status" }).click();
  const other = await open_page(browser, guarded.url, { context: page.context(), expected: (url, status) => status === 401 });
  await other.getByLabel("Access token").waitFor(); // another tab does not
  assert.deepEqual(other.errors, []);
  // Frames of other sites may have no storage. The page knows the token until it is left.
  const frame = await open_page(browser, "about:blank", { expected: (url, status) => status === 401 });
  await frame.addInitScript(() =>
    Object.defineProperty(window, "sessionStorage", {
      get: () => {
        throw new DOMException("denied", "SecurityError");
      },
    }),
  );
  await frame.goto(guarded.url);
  await frame.getByLabel("Access token").fill("open-sesame");
  await frame.getByRole("button", { name: "Open" }).click();
  await settled(frame);
  await close(frame);
  await close(page);
  assert.deepEqual(await guarded.stop(), []);
});

test("when the server goes away, the page says so, keeps what is on screen, and goes on by itself when the server is back", async () => {
  let mortal = await serve(grid_file("stadium"));
  const page = await open_grid(browser, `${mortal.url}#g=stadium`, { expected: (url, status) => status === 0 });
  await page.waitForSelector('.overview[data-state="sharp"]');
  await page.mouse.move(...(await point_of(page, "z")));
  const before = shares((await pixels(page, "z")).data);
  await mortal.kill();
  await page.keyboard.press("Shift+>");
  await page.keyboard.press("Shift+>");
  const banner = page.getByText("The server has not answered since");
  await banner.waitFor();
  const overview = page.getByText("What is seen could not be loaded");
  await overview.waitFor();
  const older = page.getByText(/^slice \d+ is shown$/);
  await older.waitFor();
  await screenshot(page, "server-lost");
  const during = shares((await pixels(page, "z")).data);
  for (const [pixel, share] of before) if (share > 0.02) assert.ok((during.get(pixel) ?? 0) > share / 2, "the picture disappeared");
  const cell = await state(page, "cell");
  mortal = await serve(grid_file("stadium"), "--port", mortal.port);
  await banner.waitFor({ state: "hidden" });
  await overview.waitFor({ state: "hidden" });
  await older.waitFor({ state: "hidden" });
  await settled(page);
  assert.deepEqual(await state(page, "cell"), cell);
  // A page that never lost the server sees the same slice; this one may still wait before it asks for its last tiles again. Without the banner the grid is
  // larger, and the link says so a moment later.
  await page.waitForFunction(() => new URLSearchParams(location.hash.slice(1)).get("zoom") === String(teracell.viewer.zoom.value));
  const other = await open_grid(browser, page.url());
  const expected = (await pixels(other, "z")).data;
  const same = async () => (await pixels(page, "z")).data.every((pixel, i) => pixel === expected[i]);
  for (const end = Date.now() + 30_000; !(await same()); await page.waitForTimeout(100)) assert.ok(Date.now() < end, "the slice is another one");
  await close(other);
  await close(page);
  assert.deepEqual(await mortal.stop(), []);
});

test("a busy server is asked again", async () => {
  const page = await open_page(browser, "about:blank", { expected: (url, status) => status === 503 });
  const refused = new Set();
  await page.route(/\/api\/v1\/grids\/stadium(\/stats.*)?$/, (route) => {
    const url = route.request().url();
    if (refused.has(url)) return route.continue();
    refused.add(url);
    return route.fulfill({ status: 503, json: { error: { code: "busy", message: "too much to do" } } });
  });
  await page.goto(`${server.url}#g=stadium`);
  await settled(page);
  await page.getByText("all cells").waitFor();
  assert.equal(refused.size, 2);
  await close(page);
});

// All text of an element is in sight: none is cut off, and none is replaced by an ellipsis.
const expect_whole = async (element) =>
  assert.deepEqual(
    await element.evaluate((e) => [e, ...e.querySelectorAll("*")].filter((part) => part.scrollWidth > part.clientWidth + 1 && getComputedStyle(part).overflowX !== "visible").map((part) => part.className)),
    [],
  );

test("a surface that is dropped on the page: all of what to do with it is said, with the command to copy", async () => {
  const page = await open_page(browser, `${server.url}#g=graded&layout=z`, { permissions: ["clipboard-read", "clipboard-write"] });
  await settled(page);
  const drop = (name) =>
    page.evaluate((file) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File(["solid"], file));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    }, name);
  await drop("left wing, final version with a name that is long enough to need a second line.STL");
  const toast = page.locator(".toast");
  await expect_whole(toast);
  await toast.getByRole("button", { name: "Copy the command" }).click();
  assert.equal(
    await page.evaluate(() => navigator.clipboard.readText()),
    "teracell mesh 'left wing, final version with a name that is long enough to need a second line.STL' --cells 200 -o 'left wing, final version with a name that is long enough to need a second line.tcell'",
  );
  await screenshot(page, "dropped-surface");
  await drop("bolt.step");
  await toast.getByText("teracell mesh bolt.step --cells 200 -o bolt.tcell").waitFor();
  for (let left = 2; left > 0; --left) await toast.first().getByRole("button", { name: "Dismiss this message" }).click();
  assert.equal(await toast.count(), 0);
  await close(page);
});

test("a link to this machine says, once it is copied, that it leads nowhere else", async () => {
  const page = await open_page(browser, `${server.url}#g=graded&layout=z&panel=share`, { permissions: ["clipboard-read", "clipboard-write"] });
  const only = page.getByText("The link works on this machine only");
  await page.getByRole("button", { name: "Copy link" }).waitFor();
  assert.equal(await only.count(), 0);
  await page.getByRole("button", { name: "Copy link" }).click();
  await only.waitFor();
  assert.match(await page.evaluate(() => navigator.clipboard.readText()), /^http:\/\/127\.0\.0\.1:\d+\/#g=graded&/);
  await close(page);
});

test("a damaged file: the parts that can't be read are striped, a message says so, and the rest is there", async () => {
  const damaged = await serve(join(folder, "damaged"));
  const { cells } = (await (await fetch(`${damaged.url}api/v1/grids/damaged`)).json()).grid;
  const middle = cells.map((n) => n >> 1); // whose slice across z is damaged
  // The window is so large that the whole slice fits with one pixel per cell.
  const options = { expected: (url, status) => status === 500 || url.endsWith("/none"), width: 2300, height: 1800 };
  const page = await open_page(browser, `${damaged.url}#g=damaged&at=${middle}&layout=z&panel=none`, options);
  await page.waitForFunction(() => window.teracell?.viewer.tiles.damaged.value > 0);
  const toast = page.locator(".toast");
  assert.equal(await toast.count(), 1);
  assert.match(await toast.innerText(), /“damaged” is damaged: .*damaged\.tcell: level 0 chunk/s);
  await expect_whole(toast);
  await quiet(page);
  await screenshot(page, "damaged");
  const { level, tiles } = await page.evaluate(() => ({ level: teracell.viewer.level[2].value, tiles: teracell.viewer.tiles.damaged.value }));
  assert.equal(level, 0);
  const found = await pixels(page, "z");
  const { healthy, striped } = await page.evaluate(async () => {
    // Asks the server for the same tiles: it can read some of them, and others not.
    const { viewer } = teracell;
    const asked = await Promise.all(
      [0, 1, 2, 3].flatMap((c) => [0, 1, 2].map((r) => fetch(viewer.address.tile(2, viewer.cell.value[2], 0, c, r)).then((answer) => answer.ok))),
    );
    return { healthy: asked.filter((ok) => ok).length, striped: asked.filter((ok) => !ok).length };
  });
  assert.ok(healthy > 0 && striped > 0, `${healthy} whole tiles, ${striped} damaged ones`);
  assert.ok(tiles >= striped);
  assert.ok(shares(found.data).size >= 4, "stripes have two colours, but the rest must show more");
  // Of the damaged tiles nothing is striped but a chunk: 64 rays wide, and as long as the grid.
  const dark = found.data.filter((pixel) => pixel === packed(194, 65, 12)).length;
  assert.ok(dark > 64 && dark < 64 * Math.max(...cells) / 4, `${dark} pixels are of a dark stripe`);
  // In three dimensions as well.
  await page.evaluate(() => {
    teracell.viewer.bodies.value = "whole";
    teracell.viewer.layout.value = "3d";
  });
  await page.waitForSelector('.overview[data-state="sharp"]');
  await page.getByText("A part of the file can't be read. It is striped here.").waitFor();
  const picture = await screenshot(page, "damaged-3d");
  const orange = picture.data.filter((pixel) => (pixel & 255) > 120 && ((pixel >> 8) & 255) < 90 && ((pixel >> 16) & 255) < 60).length;
  assert.ok(orange > 2000, `${orange} pixels are of a stripe`);
  await page.goto(`${damaged.url}?grid=none.tcell`);
  await page.getByText("There is no grid “none” here.").waitFor();
  await page.waitForSelector('.card.damaged [title*="chunk"]');
  await close(page);
  const told = await damaged.stop((line) => line.startsWith("teracell: ") || JSON.parse(line).status === 500);
  assert.deepEqual(told, []);
});

// Texts with too little contrast by WCAG 2, measured against the first background below them that is not transparent.
const poor_contrasts = (page) =>
  page.evaluate(() => {
    const parse = (text) => {
      const context = new OffscreenCanvas(1, 1).getContext("2d");
      context.fillStyle = text;
      context.fillRect(0, 0, 1, 1);
      const [r, g, b, a] = context.getImageData(0, 0, 1, 1).data;
      return { rgb: [r, g, b], alpha: a / 255 };
    };
    const luminance = (rgb) => {
      const [r, g, b] = rgb.map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const ground_of = (element) => {
      for (let e = element; e; e = e.parentElement) {
        const { rgb, alpha } = parse(getComputedStyle(e).backgroundColor);
        if (alpha > 0.9) return rgb;
      }
      return [255, 255, 255];
    };
    const poor = [];
    for (const element of document.querySelectorAll("body *")) {
      const text = [...element.childNodes].filter((n) => n.nodeType === 3 && n.textContent.trim()).map((n) => n.textContent.trim());
      if (!text.length || !element.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
      if (element.closest("[disabled], [aria-hidden=true], .view-overview, noscript")) continue;
      const style = getComputedStyle(element);
      const [a, b] = [luminance(parse(style.color).rgb), luminance(ground_of(element))].sort((x, y) => y - x);
      const large = Number.parseFloat(style.fontSize) >= 24 || (Number.parseFloat(style.fontSize) >= 18.66 && Number(style.fontWeight) >= 700);
      const ratio = (a + 0.05) / (b + 0.05);
      if (ratio < (large ? 3 : 4.5)) poor.push(`${text[0].slice(0, 40)} (${element.className}): ${ratio.toFixed(2)}`);
    }
    return poor;
  });

for (const theme of ["light", "dark"])
  test(`the ${theme} theme follows the system, all text is readable, and the switch is remembered`, async () => {
    const page = await open_grid(browser, `${server.url}#g=open`, { colorScheme: theme });
    const luminance = async () => {
      const { data } = await screenshot(page, `${theme}`);
      return data.reduce((sum, p) => sum + (p & 255) + ((p >> 8) & 255) + ((p >> 16) & 255), 0) / (3 * 255 * data.length);
    };
    const bright = await luminance();
    assert.ok(theme === "light" ? bright > 0.6 : bright < 0.4, `mean brightness ${bright}`);
    for (const tab of ["Materials", "Report", "Box", "Link", "Status"]) {
      await page.getByRole("tab", { name: tab }).click();
      await page.waitForLoadState("networkidle");
      assert.deepEqual(await poor_contrasts(page), [], tab);
    }
    await page.getByRole("button", { name: theme === "light" ? "Use dark colours" : "Use light colours" }).click();
    await settled(page);
    const other = await luminance();
    assert.ok(theme === "light" ? other < 0.4 : other > 0.6, `mean brightness ${other}`);
    await page.reload();
    await settled(page);
    assert.ok(Math.abs((await luminance()) - other) < 0.1, "the switch was forgotten");
    await close(page);
  });

for (const [name, width, height] of [["tablet, upright", 820, 1180], ["tablet", 1180, 820], ["laptop", 1280, 720]])
  test(`${name}: everything fits, nothing scrolls sideways`, async () => {
    const page = await open_grid(browser, `${server.url}#g=stadium`, { width, height, hasTouch: true });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(wide <= 0, `${wide} pixels too wide`);
    for (const axis of ["x", "y", "z"]) {
      const box = await view(page, axis).boundingBox();
      assert.ok(box && box.width >= 120 && box.height >= 80, `the view across ${axis} is ${box?.width} x ${box?.height}`);
    }
    const { data } = await screenshot(page, name.replaceAll(/\W+/g, "-"));
    assert.ok(new Set(data).size > 20);
    await close(page);
  });

test("the ends of the triad are large enough to hit, and a marker says what it marks", async () => {
  const page = await open_page(browser, `${server.url}#g=open&layout=3d&panel=report`);
  await page.waitForSelector('.overview[data-state="sharp"]');
  const missed = await page.evaluate(() =>
    [...document.querySelectorAll(".overview-end")].filter((end) => {
      if (end.style.visibility === "hidden") return false; // a nearer one covers it
      const { left, top, width, height } = end.getBoundingClientRect();
      const hit = (dx, dy) => document.elementFromPoint(left + width / 2 + dx, top + height / 2 + dy)?.closest(".overview-end");
      return ![[11, 0], [-11, 0], [0, 11], [0, -11]].every(([dx, dy]) => hit(dx, dy));
    }).length,
  );
  assert.equal(missed, 0);
  await page.waitForFunction(() => teracell.viewer.markers.value.length === 1);
  const [{ at, text }] = await state(page, "markers");
  await page.evaluate((target) => (teracell.viewer.orbit.value = { azimuth: 30, elevation: 20, distance: 4, target }), at);
  const { x, y, width, height } = await page.locator(".overview > canvas").boundingBox();
  await page.mouse.move(x + width / 2 + 2, y + height / 2);
  assert.equal(await page.locator(".overview > canvas").getAttribute("title"), text);
  await page.mouse.move(x + width / 2 + 40, y + height / 2);
  assert.equal(await page.locator(".overview > canvas").getAttribute("title"), "");
  await close(page);
});

test("the swatch of a transparent material is a checkerboard", async () => {
  const page = await open_grid(browser, `${server.url}#g=open`);
  const colors = async (name) => new Set(decoded_png(await page.getByLabel(`Colour of ${name}`).screenshot()).data);
  const air = await colors("air");
  assert.ok(!air.has(packed(0, 0, 0)) && air.has(packed(0xda, 0xdf, 0xe6)) && air.has(packed(0xff, 0xff, 0xff)), "air is not transparent");
  assert.ok((await colors("tin")).has(packed(0xcc, 0x66, 0x77)));
  await close(page);
});


test("with the keyboard alone, every control can be reached, seen and used", async () => {
  const page = await open_grid(browser, `${server.url}#g=stadium`);
  const focused = () =>
    page.evaluate(() => {
      const e = document.activeElement;
      const style = getComputedStyle(e);
      const rings = [style, getComputedStyle(e, "::after")];
      const ring = rings.some(
        (s) =>
          (s.outlineStyle !== "none" && Number.parseFloat(s.outlineWidth) > 0) ||
          s.boxShadow !== "none" ||
          (s.content !== "none" && s.content !== "normal" && Number.parseFloat(s.borderWidth) > 0),
      );
      return { name: e.getAttribute("aria-label") ?? e.innerText ?? "", role: e.getAttribute("role") ?? e.tagName.toLowerCase(), ring };
    });
  const names = [];
  const used = { slice: false, hidden: false };
  const comes = (...condition) => page.waitForFunction(...condition, { timeout: 5000 }).then(() => true, () => false);
  for (let n = 0; n < 80; ++n) {
    await page.keyboard.press("Tab");
    const at = await focused();
    if (at.role === "body") break;
    assert.ok(at.ring, `the focus can't be seen at ${at.name} (${at.role})`);
    names.push(`${at.role} ${at.name}`.trim());
    if (/^Slice \d+ across y/.test(at.name)) {
      const [, j] = await state(page, "cell");
      await page.keyboard.press(".");
      used.slice = await comes((next) => teracell.viewer.cell.value[1] === next, j + 1);
    }
    if (at.name === `Show ${info_of("stadium").materials[1].name}`) {
      await page.keyboard.press("Space");
      used.hidden = await comes(() => !teracell.viewer.looks.value[1].visible, null);
    }
  }
  assert.deepEqual(used, { slice: true, hidden: true }, `reached: ${names.join("; ")}`);
  for (const expected of [
    "Only the slice across x", "Help", "Slice across z", "Play the slices across x", "Column along y", "Pin this cell", "Materials", "Colour of",
  ])
    assert.ok(
      names.some((name) => name.includes(expected)),
      `${expected} was not reached: ${names.join("; ")}`,
    );
  await page.getByRole("tab", { name: "Materials" }).focus();
  await page.keyboard.press("ArrowRight");
  assert.equal(await state(page, "panel"), "report");
  await close(page);
});
