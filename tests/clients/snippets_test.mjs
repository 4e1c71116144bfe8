// The lines that the dashboard offers for other programs (web/src/panels/share_links.ts) are run unchanged, and their results
// compared with `teracell export`. The state in the link to Neuroglancer is opened in npm's neuroglancer.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { expect_same, exported, folder, grids, open_browser, screenshot, server } from "./support.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const bundle = join(folder, "share_links.mjs");
await build({ entryPoints: [join(here, "../../web/src/panels/share_links.ts")], bundle: true, format: "esm", outfile: bundle, logLevel: "warning" });
const { doors, neuroglancer_state } = await import(bundle);

let browser;
before(async () => (browser = await open_browser()));
after(() => browser.close());

const grid = "stadium";
const cell = grids[grid].grid.cells.map((n) => n >> 1);
const all = doors({ ...grids[grid], id: grid }, server, cell);
const door = (name) => all.find((d) => d.name.startsWith(name));

// Debian's Python runs the lines and then `rest`, which writes snippet.raw.
function python(lines, rest) {
  execFileSync("/usr/bin/python3", ["-c", `${lines}\nimport numpy\n${rest}`], { cwd: folder, stdio: ["ignore", "inherit", "inherit"] });
  return new Uint8Array(readFileSync(join(folder, "snippet.raw")));
}
const write = (what) => `numpy.asarray(${what}).astype("u1").tofile("snippet.raw")`;

// The grid is so small that every snippet asks for level 0.
const cells = exported(grid, 0);
const [, ny, nx] = cells.shape;
const slice = cells.data.subarray(cell[2] * ny * nx, (cell[2] + 1) * ny * nx);

test("every program with lines is run here", () => {
  const run = ["Python: zarr", "Python: xarray", "Python: dask", "ParaView", "JavaScript: zarrita", "OpenSeadragon (Deep Zoom)", "curl"];
  assert.deepEqual(all.filter((d) => d.lines).map((d) => d.name), run);
});

// Modules of Debian's packages that don't come with those that are named are not found here: the lines run all the same.
test("the packages that are named are enough", () => {
  const run = (text) => execFileSync("/usr/bin/python3", ["-c", text], { cwd: folder, encoding: "utf8" });
  const of_debian = `import sys
for m in list(sys.modules.values()):
    file = getattr(m, "__file__", None) or ""
    if file.startswith("/usr/lib/python3/dist-packages/"): print(m.__name__.split(".")[0], file)`;
  const depends = ["depends", "--recurse", "--no-recommends", "--no-suggests", "--no-conflicts", "--no-breaks", "--no-replaces", "--no-enhances"];
  for (const { name, lines, packages } of all.filter((d) => d.language === "python")) {
    const modules = run(`${lines}\n${of_debian}`).trim().split("\n").map((line) => line.split(" "));
    const owners = execFileSync("dpkg", ["-S", ...new Set(modules.map(([, file]) => file))], { encoding: "utf8" }).trim().split("\n");
    const owner = new Map(owners.map((line) => [line.slice(line.indexOf(": ") + 2), line.split(":")[0]])); // "python3-x:amd64: /usr/..."
    const come = execFileSync("apt-cache", [...depends, ...packages], { encoding: "utf8", maxBuffer: 1 << 26 });
    const there = new Set(come.split("\n").filter((line) => /^\S/.test(line)));
    const missing = new Set(modules.filter(([, file]) => !there.has(owner.get(file))).map(([module]) => module));
    assert.ok(modules.length > missing.size, `${name} uses no module of its packages`);
    const without = `import sys
from importlib.machinery import PathFinder
class Without(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return None if name.split(".")[0] in ${JSON.stringify([...missing])} else super().find_spec(name, path, target)
sys.meta_path = [Without if finder is PathFinder else finder for finder in sys.meta_path]`;
    run(`${without}\n${lines}`);
  }
});

test("Python: zarr", () => expect_same(python(door("Python: zarr").lines, write("cells")), slice, "the slice"));
test("Python: xarray", () => expect_same(python(door("Python: xarray").lines, write("label")), cells.data, "the grid"));

test("Python: dask", () => {
  const counts = [...cells.data].reduce((sum, material) => ((sum[material] += 1), sum), grids[grid].materials.map(() => 0));
  const found = python(door("Python: dask").lines, 'numpy.asarray(counts, "<f8").tofile("snippet.raw")');
  assert.deepEqual([...new Float64Array(found.buffer)], counts);
});

test("ParaView: the file has the cells and their coordinates", () => {
  const found = python(door("ParaView").lines, `import netCDF4\nfile = netCDF4.Dataset("grid.nc")\nassert file["label"].dtype == "i2" and file["label"].dimensions == ("z", "y", "x")\n${write('file["label"][:]')}`);
  expect_same(found, cells.data, "the grid");
});

test("JavaScript: zarrita", () => {
  const program = `${door("JavaScript").lines}\nprocess.stdout.write(Buffer.from(cells.data).toString("base64"));`;
  const text = execFileSync("node", ["--input-type=module", "-e", program], { cwd: here, encoding: "utf8", maxBuffer: 1 << 28 });
  expect_same(new Uint8Array(Buffer.from(text, "base64")), slice, "the slice");
});

test("OpenSeadragon", async () => {
  const { page, errors } = await browser.open("openseadragon.html");
  await page.evaluate(async (lines) => {
    const element = document.getElementById("picture");
    element.id = "view";
    element.style.cssText = "width: 600px; height: 480px";
    const viewer = new Function(`return ${lines}`)();
    await new Promise((opened, failed) => (viewer.addHandler("open", opened), viewer.addHandler("open-failed", failed)));
    const item = viewer.world.getItemAt(0);
    if (!item.getFullyLoaded()) await new Promise((loaded) => item.addOnceHandler("fully-loaded-change", loaded));
  }, door("OpenSeadragon").lines);
  assert.ok((await screenshot(page, "snippet-openseadragon")).length > 2);
  assert.deepEqual(errors, []);
  await page.close();
});

test("IIIF: the address is the document", async () => {
  const info = await (await fetch(door("IIIF").address)).json();
  assert.deepEqual([info.type, info.width, info.height], ["ImageService3", nx, ny]);
});

test("curl", () => {
  const column = JSON.parse(execFileSync("bash", ["-c", door("curl").lines], { cwd: folder, encoding: "utf8" }));
  const found = column.runs.flatMap((run) => Array(run.to - run.from).fill(run.material));
  assert.deepEqual(found, Array.from({ length: cells.shape[0] }, (_, z) => cells.data[(z * ny + cell[1]) * nx + cell[0]]));
  const picture = readFileSync(join(folder, "slice.png"));
  assert.deepEqual([picture.readUInt32BE(16), picture.readUInt32BE(20)], [nx, ny]);
});

test("the link into Neuroglancer shows the materials in their colours", async () => {
  const looks = grids[grid].materials.map(({ color }) => ({ color: [1, 3, 5].map((at) => Number.parseInt(color.slice(at, at + 2), 16)), visible: true, opacity: 1 }));
  const state = neuroglancer_state({ ...grids[grid], id: grid }, server, cell, looks, 3);
  const { page, errors } = await browser.open(`neuroglancer/neuroglancer.html#!${encodeURIComponent(JSON.stringify(state))}`);
  await page.waitForFunction(() => window.viewer?.layerManager.managedLayers[0]?.isReady() && viewer.isReady(), null, { timeout: 60000 });
  assert.deepEqual(await page.evaluate(() => [...viewer.navigationState.position.value].map(Math.floor)), cell);
  const near = (color, colors) => colors.some((c) => color.every((v, i) => Math.abs(((c >> (8 * i)) & 255) - v) <= 2));
  let unseen;
  for (let n = 0; n < 40; ++n) {
    await page.waitForTimeout(250); // time for a frame of the software renderer
    const colors = await screenshot(page, "snippet-neuroglancer");
    unseen = [...new Set(slice)].filter((id) => id > 0 && !near(looks[id].color, colors)).map((id) => grids[grid].materials[id].name);
    if (unseen.length === 0) break;
  }
  assert.deepEqual(unseen, []);
  assert.deepEqual(errors, []);
  await page.close();
});
