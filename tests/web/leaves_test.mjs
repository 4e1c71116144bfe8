// The leaves of the refined grid, in the slices and counted, are those of `teracell export`.
import assert from "node:assert/strict";
import test from "node:test";
import {
  cells_of_pixels, close, leaf_count_of, leaves_of_slice, open_grid, packed, pixels, screenshot, server_and_browser, settled, state, view,
} from "./support.mjs";

const { server, browser } = await server_and_browser();
const COLORS = [[200, 30, 30], [230, 110, 20], [205, 165, 0], [110, 170, 40], [20, 150, 110], [20, 130, 200], [50, 70, 190], [120, 50, 160]];

// The colour of the line at each pixel, and 0 where there is none.
function expected_lines(grid, axis, leaves, looks, width, height) {
  const { columns, rows } = cells_of_pixels(grid, axis, looks, width, height);
  const [u, v] = [[1, 2], [0, 2], [0, 1]]["xyz".indexOf(axis)];
  const at = new Map();
  leaves.forEach(({ level, cell }, n) => at.set([level, cell[u], cell[v]].join(), n));
  const leaf = (x, y) => {
    if ((columns[x] ?? -1) < 0 || (rows[y] ?? -1) < 0) return -1;
    for (let level = 0; level <= 16; ++level) {
      const n = at.get([level, columns[x] >> level, rows[y] >> level].join());
      if (n !== undefined) return n;
    }
    throw new Error(`no leaf at ${columns[x]}, ${rows[y]}`);
  };
  return Uint32Array.from({ length: width * height }, (_, i) => {
    const [x, y] = [i % width, Math.floor(i / width)];
    const here = leaf(x, y);
    const begins = (before, after) => here >= 0 && before !== here && after === here;
    return begins(leaf(x - 1, y), leaf(x + 1, y)) || begins(leaf(x, y + 1), leaf(x, y - 1)) ? packed(...COLORS[leaves[here].level % 8]) : 0;
  });
}

for (const [grid, axis, refine, want, zoom] of [
  ["stadium", "z", "5,2", "interface=0", 8], ["stadium", "x", "4,1", "interface=1,inside:grandstand=0", 9], ["graded", "y", "3,1", "material:gold=0,interface=2", 30],
])
  test(`${grid}: lines between leaves across ${axis}, refined by ${refine} for ${want}, are where leaves begin`, async () => {
    const query = `layout=${axis}&axes=0&lines=0&panel=none&refine=${refine}&want=${encodeURIComponent(want)}&zoom=${zoom}`;
    const without = await open_grid(browser, `${server.url}#g=${grid}&${query}`, { width: 500, height: 420 });
    const before = await pixels(without, axis);
    await without.keyboard.press("r");
    await settled(without);
    const { width, height, data } = await pixels(without, axis);
    const looks = { centre: await state(without, "centre"), zoom: await state(without, "zoom"), cell: await state(without, "cell") };
    const leaves = leaves_of_slice(grid, axis, looks.cell["xyz".indexOf(axis)], refine, want);
    const lines = expected_lines(grid, axis, leaves, looks, width, height);
    let drawn = 0;
    for (let i = 0; i < lines.length; ++i) {
      assert.equal(data[i], lines[i] || before.data[i], `pixel ${i % width}, ${Math.floor(i / width)}`);
      drawn += lines[i] ? 1 : 0;
    }
    assert.ok(drawn > 500, `${drawn} pixels of lines`);
    await close(without);
  });

test("the panel counts leaves by level and material, and says what is wrong with a wish", async () => {
  const page = await open_grid(browser, `${server.url}#g=stadium&panel=leaves`, { expected: (url, status) => status === 400 && url.includes("nobody") });
  const digits = (text) => text.replace(/\D/g, "");
  const table = (n) => page.locator("#panel-content table").nth(n);
  const rows = async (n) => Promise.all((await table(n).locator("tbody tr").all()).map((row) => row.innerText().then((text) => text.split(/\t|\n/))));
  await page.getByLabel("Coarsest level").fill("4");
  await page.getByLabel("Layers of cells of each level").fill("1");
  await page.getByLabel("What is fine").fill("interface=1,inside:explosive=0");
  await page.getByLabel("What is fine").press("Enter");
  await page.getByText("--refine 4,1").first().waitFor();
  const counted = leaf_count_of("stadium", "4,1", "interface=1,inside:explosive=0");
  await page.locator("#panel-content b").filter({ hasText: new RegExp(`^${String(counted.total).replace(/\B(?=(\d{3})+$)/g, "\\D?")}$`) }).waitFor();
  const sums = (key) => {
    const out = {};
    for (const row of counted.leaves) out[row[key]] = (out[row[key]] ?? 0) + row.leaves;
    return out;
  };
  const [levels, materials] = [sums("level"), sums("material")];
  assert.deepEqual((await rows(0)).map((row) => [row[0].trim(), digits(row.at(-1))]), [0, 1, 2, 3, 4].map((level) => [String(level), String(levels[level] ?? 0)]));
  assert.deepEqual((await rows(1)).map((row) => [row[0].trim(), digits(row[1])]), Object.entries(materials).map(([name, n]) => [name, String(n)]));
  await page.getByLabel("Draw the leaves").check();
  await settled(page);
  await screenshot(page, "leaves");
  await page.waitForFunction(() => location.hash.includes("refine=4,1") && location.hash.includes("leaves=1"));
  await page.getByLabel("What is fine").fill("material:nobody=0");
  await page.getByLabel("What is fine").press("Enter");
  await page.getByRole("alert").getByText("nobody").first().waitFor();
  await page.getByText("The leaves can't be drawn").waitFor();
  await settled(page); // what was refused isn't waited for
  await view(page, "z").click();
  await close(page);
});
