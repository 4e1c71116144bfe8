// npm's zarrita reads the folders and zips that `teracell export` writes: Zarr v3 with shards and OME-Zarr 0.5.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import FileSystemStore from "@zarrita/storage/fs";
import ZipFileStore from "@zarrita/storage/zip";
import * as zarr from "zarrita";
import { read_npy } from "../support/npy.mjs";
import { expect_same, exported, folder, grids } from "./support.mjs";

const kUnits = { m: "meter", mm: "millimeter" };

function teracell(...args) {
  execFileSync(process.env.TERACELL, args.map(String), { cwd: folder, stdio: ["ignore", "ignore", "inherit"] });
}

async function written(grid, name, ...more) {
  if (!existsSync(join(folder, name))) teracell("export", grid, "-o", name, ...more);
  return name.endsWith(".zarr") ? new FileSystemStore(join(folder, name)) : ZipFileStore.fromBlob(new Blob([readFileSync(join(folder, name))]));
}

// What the specification of OME-Zarr 0.5 says of "multiscales" and "image-label".
async function expect_ome(group, store) {
  const { version, multiscales, "image-label": label } = group.attrs.ome;
  assert.equal(version, "0.5");
  assert.equal(multiscales.length, 1);
  const [{ axes, datasets, name }] = multiscales;
  assert.equal(typeof name, "string");
  assert.deepEqual(axes.map((axis) => axis.name), ["z", "y", "x"]);
  for (const axis of axes) assert.equal(axis.type, "space");
  assert.ok(datasets.length > 0);
  let before = null;
  for (const { path, coordinateTransformations } of datasets) {
    const array = await zarr.open.v3(zarr.root(store).resolve(path), { kind: "array" });
    assert.deepEqual(array.dimensionNames, axes.map((axis) => axis.name));
    assert.deepEqual(coordinateTransformations.map((t) => t.type), ["scale", "translation"]);  // one scale, then at most one translation
    const [{ scale }, { translation }] = coordinateTransformations;
    for (const numbers of [scale, translation]) assert.ok(numbers.length === 3 && numbers.every(Number.isFinite));
    assert.ok(scale.every((s, d) => s > 0 && (before === null || s > before[d])), "from the finest to the coarsest");
    before = scale;
  }
  for (const list of [label.colors, label.properties]) {
    assert.ok(list.length > 0);
    assert.equal(new Set(list.map((entry) => entry["label-value"])).size, list.length);
    assert.ok(list.every((entry) => Number.isInteger(entry["label-value"])));
  }
  for (const { rgba } of label.colors) assert.ok(rgba.length === 4 && rgba.every((c) => Number.isInteger(c) && c >= 0 && c <= 255));
}

for (const [grid, info] of Object.entries(grids)) {
  const levels = info.levels.length;

  for (const name of [`${grid}.zarr`, `${grid}.zarr.zip`, `${grid}.ozx`]) {
    test(`every level of ${name} is as exported`, async () => {
      const store = await written(`${grid}.tcell`, name);
      const group = await zarr.open.v3(store, { kind: "group" });
      await expect_ome(group, store);
      for (let level = 0; level < levels; ++level) {
        const { shape, data } = exported(grid, level);
        const array = await zarr.open.v3(group.resolve(String(level)), { kind: "array" });
        assert.deepEqual(array.shape, shape);
        assert.equal(array.dtype, info.materials.length > 256 ? "uint16" : "uint8");
        expect_same((await zarr.get(array)).data, data, `level ${level}`);
      }
    });
  }

  test(`${grid}'s documents are listed in that of the root`, async () => {
    const store = await zarr.withConsolidatedMetadata(await written(`${grid}.tcell`, `${grid}.zarr`), { format: "v3" });
    assert.deepEqual(
      store.contents().map(({ path, kind }) => `${kind} ${path}`).sort(),
      ["group /", ...Array.from({ length: levels }, (_, level) => `array /${level}`)].sort(),
    );
  });

  test(`the names, colours and places of ${grid}'s cells`, async () => {
    const group = await zarr.open.v3(await written(`${grid}.tcell`, `${grid}.zarr`), { kind: "group" });
    const { "image-label": { properties, colors }, multiscales: [{ axes, datasets }] } = group.attrs.ome;
    assert.deepEqual(properties.map((p) => [p["label-value"], p.name]), info.materials.map((m) => [m.id, m.name]));
    const hex = (rgba) => "#" + rgba.map((c) => c.toString(16).padStart(2, "0")).join("");
    assert.deepEqual(colors.map((c) => [c["label-value"], hex(c.rgba)]), info.materials.map((m) => [m.id, m.color.padEnd(9, "f")]));
    const graded = info.grid.axes.some((axis) => axis.type === "graded");
    assert.deepEqual(axes.map((axis) => axis.unit), Array(3).fill(graded ? undefined : kUnits[info.units]));
    for (const [level, { coordinateTransformations: [{ scale }, { translation }] }] of datasets.entries())
      for (let d = 0; d < 3; ++d) {
        const { min, step } = graded ? { min: -0.5, step: 1 } : info.grid.axes[2 - d];  // a graded grid is in index space
        assert.equal(scale[d], step * 2 ** level);
        assert.ok(Math.abs(translation[d] - min - (step * 2 ** level) / 2) <= 1e-12 * (Math.abs(min) + step));
      }
    if (graded) assert.deepEqual(group.attrs.teracell.planes.x, info.grid.axes[0].planes);
  });

  test(`a region of ${grid} from level 1 up lies where its cells lie in the whole`, async () => {
    const [lo, hi] = [[7, 5, 3], [140, 99, 5]];  // z from 3 to 5: both grids have it
    const store = await written(`${grid}.tcell`, `${grid}.part.ozx`, "--level", 1, "--region", [...lo, ...hi]);
    const group = await zarr.open.v3(store, { kind: "group" });
    await expect_ome(group, store);
    const whole = (await zarr.open.v3(await written(`${grid}.tcell`, `${grid}.zarr`), { kind: "group" })).attrs.ome.multiscales[0].datasets;
    for (let level = 1; level < levels; ++level) {
      const from = lo.map((n) => n >> (level - 1)), to = hi.map((n) => Math.ceil(n / 2 ** (level - 1)));
      const { shape: [, ny, nx], data } = exported(grid, level);
      const expected = [];
      for (let z = from[2]; z < to[2]; ++z) for (let y = from[1]; y < to[1]; ++y) expected.push(...data.subarray((z * ny + y) * nx + from[0], (z * ny + y) * nx + to[0]));
      const array = await zarr.open.v3(group.resolve(String(level)), { kind: "array" });
      assert.deepEqual(array.shape, [2, 1, 0].map((d) => to[d] - from[d]));
      expect_same((await zarr.get(array)).data, expected, `level ${level}`);
      const [here, there] = [group.attrs.ome.multiscales[0].datasets, whole].map((list) => list.find(({ path }) => path === String(level))?.coordinateTransformations);
      if (!here) continue;
      assert.deepEqual(here[0], there[0]);
      for (let d = 0; d < 3; ++d) {
        const expected_place = there[1].translation[d] + from[2 - d] * there[0].scale[d];
        assert.ok(Math.abs(here[1].translation[d] - expected_place) <= 1e-12 * (1 + Math.abs(expected_place)));
      }
    }
    await assert.rejects(zarr.open.v3(group.resolve("0"), { kind: "array" }), { name: "NotFoundError" });
  });
}

test("more than one shard", async () => {
  teracell("mesh", "stadium/scene.json", "--cells", 1100, "-o", "large.tcell");
  const store = await written("large.tcell", "large.zarr");
  const array = await zarr.open.v3(zarr.root(store).resolve("0"), { kind: "array" });
  const [nz, ny, nx] = array.shape;
  assert.ok(nx > 1024 && ny > 512, `${array.shape}`);
  for (const [x, y, z] of [[460, 460, 0], [980, 480, nz - 90], [nx - 100, ny - 100, 0], [0, 500, 0]]) {
    const hi = [Math.min(nx, x + 100), Math.min(ny, y + 100), Math.min(nz, z + 90)];
    const name = `large-${x}-${y}-${z}.npy`;
    teracell("export", "large.tcell", "-o", name, "--region", [x, y, z, ...hi]);
    const part = await zarr.get(array, [zarr.slice(z, hi[2]), zarr.slice(y, hi[1]), zarr.slice(x, hi[0])]);
    expect_same(part.data, read_npy(join(folder, name)).data, name);
  }
});
