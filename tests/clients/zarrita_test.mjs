// npm's zarrita: Zarr v3 with OME-Zarr 0.5, and Zarr v2.
import assert from "node:assert/strict";
import test from "node:test";
import * as zarr from "zarrita";
import { expect_same, exported, grids, server } from "./support.mjs";

const kUnits = { m: "meter", mm: "millimeter" };

function v3(path) {
  return zarr.withConsolidatedMetadata(new zarr.FetchStore(`${server}/zarr/${path}`), { format: "v3" });
}

async function expect_export(array, grid, level, what) {
  const { shape, data } = exported(grid, level);
  assert.deepEqual(array.shape, shape, what);
  assert.equal(array.dtype, grids[grid].materials.length > 256 ? "uint16" : "uint8", what);
  expect_same((await zarr.get(array)).data, data, what);
}

for (const [grid, info] of Object.entries(grids)) {
  const levels = info.levels.length;
  // The last listed level is the first that is a single block. Coarser levels exist, but are not listed.
  const listed = Array.from({ length: 1 + info.levels.findIndex(({ cells }) => Math.max(...cells) <= 64) }, (_, level) => String(level));

  for (const path of [grid, `${grid}/labels/material`]) {
    test(`v3: every level of ${path} is as exported`, async () => {
      const group = await zarr.open.v3(new zarr.FetchStore(`${server}/zarr/${path}`), { kind: "group" });
      const { version, multiscales } = group.attrs.ome;
      assert.equal(version, "0.5");
      assert.deepEqual(multiscales[0].datasets.map(({ path }) => path), listed);
      for (let level = 0; level < levels; ++level) {
        const array = await zarr.open.v3(group.resolve(String(level)), { kind: "array" });
        assert.deepEqual(array.dimensionNames, ["z", "y", "x"]);
        await expect_export(array, grid, level, `${path} level ${level}`);
      }
    });
  }

  test(`v3: the places of ${grid}'s cells`, async () => {
    const group = await zarr.open(new zarr.FetchStore(`${server}/zarr/${grid}`), { kind: "group" });
    const { axes, datasets } = group.attrs.ome.multiscales[0];
    assert.deepEqual(axes.map((axis) => axis.name), ["z", "y", "x"]);
    const graded = info.grid.axes.some((axis) => axis.type === "graded");
    assert.deepEqual(axes.map((axis) => axis.unit), Array(3).fill(graded ? undefined : kUnits[info.units]));
    for (const [level, { coordinateTransformations: [scale, translation] }] of datasets.entries()) {
      ["z", "y", "x"].forEach((_, i) => {
        // OME-Zarr can't describe a graded axis, so such a grid is in index space.
        const { min, step } = graded ? { min: -0.5, step: 1 } : info.grid.axes[2 - i];
        assert.equal(scale.scale[i], step * 2 ** level);
        const centre = min + (step * 2 ** level) / 2;
        assert.ok(Math.abs(translation.translation[i] - centre) <= 1e-12 * (Math.abs(min) + step), `level ${level}: ${translation.translation}, expected ${centre}`);
      });
    }
  });

  test(`v3: ${grid}'s consolidated metadata lists all that is there`, async () => {
    const store = await v3(grid);
    const listed = store.contents().map(({ path, kind }) => `${kind} ${path}`);
    const arrays = Array.from({ length: levels }, (_, level) => level);
    assert.deepEqual(listed.sort(), [
      "group /", "group /labels", "group /labels/material",
      ...arrays.map((level) => `array /${level}`), ...arrays.map((level) => `array /labels/material/${level}`),
    ].sort());
    await expect_export(await zarr.open.v3(zarr.root(store).resolve(String(levels - 2)), { kind: "array" }), grid, levels - 2, "by consolidated metadata");
  });

  test(`v3: the names and colours of ${grid}'s labels`, async () => {
    const label = await zarr.open.v3(new zarr.FetchStore(`${server}/zarr/${grid}/labels/material`), { kind: "group" });
    const { properties, colors } = label.attrs.ome["image-label"];
    assert.deepEqual(properties.map((p) => [p["label-value"], p.name]), info.materials.map((m) => [m.id, m.name]));
    const hex = (rgba) => "#" + rgba.map((c) => c.toString(16).padStart(2, "0")).join("");
    assert.deepEqual(colors.map((c) => [c["label-value"], hex(c.rgba)]), info.materials.map((m) => [m.id, m.color.padEnd(9, "f")]));
  });

  test(`v2: every level of ${grid} is as exported`, async () => {
    const group = await zarr.open.v2(new zarr.FetchStore(`${server}/zarr2/${grid}`), { kind: "group" });
    assert.deepEqual(group.attrs.multiscales[0].datasets.map(({ path }) => path), listed);
    for (let level = 0; level < levels; ++level) {
      await expect_export(await zarr.open.v2(group.resolve(String(level)), { kind: "array" }), grid, level, `v2 ${grid} level ${level}`);
    }
  });

  test(`a part of ${grid} across the edges of chunks`, async () => {
    const { shape: [, ny, nx], data } = exported(grid, 0);
    for (const [open, path] of [[zarr.open.v3, "zarr"], [zarr.open.v2, "zarr2"]]) {
      const array = await open(new zarr.FetchStore(`${server}/${path}/${grid}/0`), { kind: "array" });
      const part = await zarr.get(array, [zarr.slice(3, 9), zarr.slice(60, 70), zarr.slice(120, 200)]);
      assert.deepEqual(part.shape, [6, 10, 80]);
      const expected = [];
      for (let z = 3; z < 9; ++z) for (let y = 60; y < 70; ++y) expected.push(...data.subarray((z * ny + y) * nx + 120, (z * ny + y) * nx + 200));
      expect_same(part.data, expected, path);
    }
  });
}

test("arrays that do not exist are not found", async () => {
  for (const path of ["zarr/nothing", "zarr2/nothing", "zarr/stadium/99", "zarr2/stadium/99"]) {
    await assert.rejects(zarr.open(new zarr.FetchStore(`${server}/${path}`), { kind: "array" }), { name: "NotFoundError" }, path);
  }
});
