// Every page and state of the dashboard against the rules of axe-core: WCAG 2.0 to 2.2, levels A and AA, and best practices. In both
// themes, on a wide screen and on a phone.
import assert from "node:assert/strict";
import test from "node:test";
import { after } from "node:test";
import { linkSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { close, folder, grid_file, open_page, serve, server_and_browser, settled } from "./support.mjs";

const axe = readFileSync(createRequire(new URL("../../web/package.json", import.meta.url)).resolve("axe-core/axe.min.js"), "utf8");
const { server, browser } = await server_and_browser();
const [bodies, checked, empty] = await Promise.all(["bodies", "checked", "empty"].map((name) => serve(join(folder, name))));
const crowd_folder = join(folder, "axe-crowd");
mkdirSync(crowd_folder);
for (const name of ["stadium", "graded", "open"]) for (const n of [1, 2]) linkSync(grid_file(name), join(crowd_folder, `${name} ${n}.tcell`));
writeFileSync(join(crowd_folder, "broken.tcell"), "not a grid");
const crowd = await serve(crowd_folder);
const token_file = join(folder, "axe-token");
writeFileSync(token_file, "open-sesame", { mode: 0o600 });
const guarded = await serve(grid_file("graded"), "--token-file", token_file);
const ended = (line) => line.startsWith("teracell: ") || line.includes("broken");
after(async () => {
  for (const one of [bodies, checked, empty, guarded]) assert.deepEqual(await one.stop(), []);
  assert.deepEqual(await crowd.stop(ended), []);
});

const click = (name) => (page) => page.getByRole("button", { name, exact: true }).click();
const key = (name) => (page) => page.keyboard.press(name);
const tab = (name) => (page) => page.getByRole("tab", { name }).click();
const opened = (selector) => (page) => page.locator(selector).evaluateAll((all) => all.forEach((one) => (one.open = true)));
const sharp = (page) => page.waitForSelector('.overview[data-state="sharp"]');
const pick = async (page) => {
  await page.locator('[data-view="z"] .view-body').click({ position: { x: 120, y: 120 } });
};

// Each state: its address, and what is done there one after the other; it is looked at after the last. Where the views
// are not the matter, one slice is shown beside what is looked at.
const STATES = {
  "start page": [crowd.url, (page) => page.locator(".preview-3d img").first().waitFor(), opened(".card details")],
  "start page, nothing found": [crowd.url, (page) => page.getByLabel("Search grids by name").fill("zzz")],
  "start page without grids": [empty.url, (page) => page.getByRole("heading", { name: "No grid here yet" }).waitFor()],
  "a grid that is not there": [`${server.url}#g=nothing`, (page) => page.getByRole("alert").waitFor()],
  "token form": [guarded.url, (page) => page.getByLabel("Access token").waitFor()],
  "token form with a fault": [guarded.url, (page) => page.getByLabel("Access token").fill("ä ö")],
  "four views": [`${server.url}#g=stadium`, settled, sharp],
  "one slice": [`${server.url}#g=graded&layout=z&panel=none`, settled],
  "3D alone": [`${server.url}#g=graded&layout=3d&bodies=glass&up=y`, sharp],
  "materials": [`${server.url}#g=stadium&layout=z`, settled, opened(".material details")],
  "bodies": [`${bodies.url}#g=bodies&layout=z&panel=bodies`, settled, (page) => page.locator("button.material-title").nth(2).click(), pick],
  "bodies that a filter finds": [`${bodies.url}#g=bodies&layout=z&panel=bodies`, settled, (page) => page.getByLabel("Filter bodies by name").fill("tier")],
  "report of a grid with a hole": [`${server.url}#g=open&layout=z&panel=report`, settled, opened(".panel-content details")],
  "report of a checked grid": [`${checked.url}#g=checked&layout=z&panel=report`, (page) => page.locator(".wall").first().waitFor(), opened(".panel-content details")],
  "box panel without a box": [`${server.url}#g=graded&layout=z&panel=box`, settled],
  "box panel": [`${server.url}#g=graded&layout=z&panel=box&box=1,2,3,40,50,12`, settled, (page) => page.locator("table.stats tbody tr").first().waitFor()],
  "share panel": [`${server.url}#g=graded&layout=z&panel=share`, settled, opened(".panel-content details")],
  "status panel": [`${server.url}#g=graded&layout=z&panel=status`, settled, (page) => page.locator(".cache").first().waitFor()],
  "help": [`${server.url}#g=graded&layout=z`, settled, key("h"), (page) => page.getByRole("dialog").waitFor()],
  "figure dialog": [`${server.url}#g=graded&layout=z`, settled, key("f"), (page) => page.getByRole("img", { name: "Preview of the figure" }).waitFor()],
  "layers": [`${server.url}#g=graded&layout=z`, settled, click("Layers over the cells")],
  "first minute": [`${server.url}#g=graded&layout=z`, settled, key("?"), click("Show me"), (page) => page.getByText("1 of 6").waitFor()],
  "places": [`${server.url}#g=graded&layout=z`, settled, key("g"), (page) => page.keyboard.type("3, 4, 500")],
  "measuring": [`${server.url}#g=graded&layout=z&measure=2,10,10,10,60,40,10`, settled, click("Measure a distance")],
  "drawing a box": [`${server.url}#g=graded&layout=z`, settled, click("Draw a box")],
  "thickness": [`${server.url}#g=graded&layout=z&panel=box`, settled, click("Thickness"), (page) => page.locator("table.stats tbody tr").first().waitFor()],
  "comparison": [`${crowd.url}#g=stadium 1&compare=stadium 2`, (page) => page.getByText("Over the whole grids").waitFor()],
  "what differs": [`${crowd.url}#g=stadium 1&compare=graded 1&mode=differs`, (page) => page.getByText("Over the whole grids").waitFor()],
  "a pinned cell": [`${server.url}#g=graded&layout=z&pin=5,6,7`, settled],
  "a message": [`${server.url}#g=graded&layout=z&at=9999,0,0`, settled, (page) => page.locator(".toast").waitFor()],
};

const SCREENS = { wide: { width: 1400, height: 900 }, phone: { width: 390, height: 844 }, landscape: { width: 844, height: 390 } };
const PASSES = [
  { screen: "wide", colorScheme: "light", states: Object.keys(STATES) },
  { screen: "phone", colorScheme: "light", states: ["start page", "bodies", "report of a checked grid", "help", "box panel", "figure dialog"] },
  { screen: "landscape", colorScheme: "dark", states: ["start page", "four views"] },
];

// What axe objects to by these rules, a line for each element.
async function violations(page, runOnly) {
  const found = await page.evaluate((runOnly) => window.axe.run(document, { runOnly, resultTypes: ["violations"] }), runOnly);
  return found.violations.flatMap(({ id, nodes }) => nodes.map(({ html, failureSummary }) => `${id}: ${html.slice(0, 160)}: ${failureSummary.split("\n")[1].trim()}`));
}

for (const { screen, colorScheme, states } of PASSES)
  test(`axe finds nothing on a ${screen} screen in the ${colorScheme === "light" ? "light theme, nor in the dark one" : "dark theme"}`, async () => {
    const wrong = new Map(); // what axe objects to, and in which states
    for (const name of states) {
      const [url, ...steps] = STATES[name];
      const page = await open_page(browser, url, { ...SCREENS[screen], colorScheme, expected: (_, status) => status === 401 || status === 404 });
      for (const step of steps) await step(page);
      await page.evaluate(axe);
      const lines = await violations(page, ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]);
      if (colorScheme === "light") {
        await page.emulateMedia({ colorScheme: "dark" }); // it has other colours, and nothing else: these rules look at colours
        await page.waitForFunction(() => document.documentElement.dataset.theme === "dark");
        lines.push(...(await violations(page, { type: "rule", values: ["color-contrast", "link-in-text-block"] })).map((line) => `dark: ${line}`));
      }
      for (const line of lines) wrong.set(line, [...(wrong.get(line) ?? []), name]);
      await close(page);
    }
    assert.deepEqual([...wrong].map(([line, where]) => `${line} (${where.join(", ")})`), []);
  });
