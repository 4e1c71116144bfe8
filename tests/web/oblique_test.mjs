// The oblique view: its pixels are those of `teracell slice --plane`, however the plane is turned, moved and made.
import assert from "node:assert/strict";
import test from "node:test";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { close, folder, grid_file, open_grid, packed, point_of, server_and_browser, set_state, settled, state } from "./support.mjs";
import { read_npy } from "../support/npy.mjs";

const program = process.env.TERACELL;
const { server, browser } = await server_and_browser();

const sharp = (page) => page.waitForSelector('.oblique[data-state="sharp"]');

// Opens a grid with the oblique view in place of z, and notes what it asks for.
async function open_oblique(at) {
  const page = await open_grid(browser, `${server.url}${at}`);
  page.asked = [];
  page.on("request", (request) => request.url().includes("/slice/plane.bin") && page.asked.push(new URL(request.url()).searchParams));
  page.spot = await point_of(page, "z", 20, 10);
  await page.mouse.move(...page.spot);
  await page.keyboard.press("o");
  await sharp(page);
  return page;
}

// The picture on the screen against the command line's, of the plane that was asked for last.
async function as_the_command_line_has_it(page, grid) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  await sharp(page);
  const asked = page.asked.at(-1);
  const [width, height] = asked.get("size").split(",").map(Number);
  const out = join(folder, "oblique.npy");
  const options = ["plane", "centre", "pixel", "size"].flatMap((name) => [`--${name}`, asked.get(name)]);
  execFileSync(program, ["slice", grid_file(grid), ...options, "--level", "0", "-o", out], { stdio: "ignore" });
  const { shape, data } = read_npy(out);
  assert.deepEqual(shape, [height, width]);
  const shown = await page.evaluate(() => {
    const canvas = document.querySelector(".oblique .view-cells");
    return [canvas.width, canvas.height, ...new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer)];
  });
  assert.deepEqual(shown.slice(0, 2), [width, height]);
  const colors = (await state(page, "looks")).map(({ color, opacity }) => (opacity === 1 ? packed(...color) : null));
  const seen = new Set();
  let wrong = 0;
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const [material, color] = [data[(height - 1 - y) * width + x], shown[2 + y * width + x]];
      seen.add(material);
      if (colors[material] === null ? colors.includes(color) : color !== colors[material]) ++wrong;
    }
  assert.equal(wrong, 0);
  return seen;
}

test("`o` shows the slice along a tilted plane through the crosshair, and again the slice across the axis", async () => {
  const page = await open_oblique("#g=stadium&at=300,200,12&zoom=6");
  assert.ok((await as_the_command_line_has_it(page, "stadium")).size > 1);
  await page.keyboard.press("o");
  assert.equal(await page.locator(".oblique").count(), 0);
  await settled(page);
  await close(page);
});

test("shift and a drag turn the plane, the wheel moves it, a drag moves the picture; the link keeps all of it", async () => {
  const page = await open_oblique("#g=stadium&at=300,200,12&zoom=6");
  const before = await state(page, "plane_normal");
  const [x, y] = page.spot;
  await page.keyboard.down("Shift");
  await page.mouse.down();
  await page.mouse.move(x + 60, y - 25, { steps: 5 });
  await page.mouse.up();
  await page.keyboard.up("Shift");
  assert.notDeepEqual(await state(page, "plane_normal"), before);
  await as_the_command_line_has_it(page, "stadium");
  const cell = await state(page, "cell");
  await page.mouse.wheel(0, 180);
  await page.waitForFunction((old) => teracell.viewer.cell.value.some((i, d) => Math.abs(i - old[d]) === 3), cell);
  await page.mouse.down();
  await page.mouse.move(x, y, { steps: 3 });
  await page.mouse.up();
  await as_the_command_line_has_it(page, "stadium");
  await page.waitForFunction(() => location.hash.includes("oblique=z"));
  await page.waitForTimeout(400);
  const again = await open_grid(browser, page.url());
  await sharp(again);
  for (const name of ["cell", "zoom", "oblique"]) assert.deepEqual(await state(again, name), await state(page, name));
  await close(again);
  await close(page);
});

test("a plane goes through three cells that are clicked in any view, and through those that are typed as angles", async () => {
  const page = await open_oblique("#g=stadium&at=300,200,12&zoom=6");
  await page.getByRole("button", { name: "Through three points" }).click();
  const cells = [[3, 5, 7], [40, 9, 12], [20, 44, 30]];
  for (const [n, cell] of cells.entries()) {
    await page.getByText(`Click ${["three points", "two more points", "one more point"][n]} in any view`).waitFor();
    await set_state(page, { pinned: cell });
  }
  await page.getByText("in any view; press Escape").waitFor({ state: "detached" });
  const [normal, points] = await page.evaluate((list) => [teracell.viewer.plane_normal.value, list.map((cell) => teracell.viewer.centre_of(cell))], cells);
  const heights = points.map((p) => p.reduce((sum, x, d) => sum + x * normal[d], 0));
  assert.ok(Math.max(...heights) - Math.min(...heights) < 1e-6, String(heights));
  const field = page.getByRole("textbox", { name: /^Azimuth/ });
  await field.fill("90");
  await field.press("Enter");
  const elevation = page.getByRole("textbox", { name: /^Elevation/ });
  await elevation.fill("0");
  await elevation.press("Enter");
  assert.deepEqual(await state(page, "plane_normal"), [0, 1, 0]);
  await as_the_command_line_has_it(page, "stadium");
  await close(page);
});
