// npm's neuroglancer in Chromium, with precomputed volumes and with Zarr v3 and v2. It shows three cross-sections. The test reads
// the cells that it has decoded for them through Neuroglancer's own functions.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { expect_same, exported, grids, open_browser, screenshot, server } from "./support.mjs";

let browser;
before(async () => (browser = await open_browser()));
after(() => browser.close());

const kMetres = { m: 1, mm: 1e-3 };

// How Neuroglancer places the cells: the unit and the edge of a cell, and the lower corner of the first cell, in cells. Graded grids
// are in index space; in OME-Zarr the origin is the centre of a cell.
function space_of(info, protocol) {
  const precomputed = protocol === "precomputed";
  if (info.grid.axes.some((axis) => axis.type === "graded")) {
    return precomputed ? { unit: "m", scale: [1e-9, 1e-9, 1e-9], first: [0, 0, 0] } : { unit: "", scale: [1, 1, 1], first: [-0.5, -0.5, -0.5] };
  }
  const axes = info.grid.axes;
  return { unit: "m", scale: axes.map((axis) => axis.step * kMetres[info.units]), first: axes.map((axis) => (precomputed ? 0 : axis.min / axis.step)) };
}

function state(grid, source, { unit, scale, first }, position) {
  return {
    dimensions: Object.fromEntries(["x", "y", "z"].map((name, i) => [name, [scale[i], unit]])),
    position: position.map((p, i) => p + 0.5 + first[i]),
    crossSectionScale: 1,
    layers: [{ type: "segmentation", name: grid, source, selectedAlpha: 1, notSelectedAlpha: 1 }],
    layout: "4panel",
  };
}

// Waits until everything that is shown has been loaded, with at least one chunk of a volume of this size [nx, ny, nz].
async function wait_for(page, size) {
  await page.waitForFunction((size) => {
    const chunks = [...viewer.dataContext.chunkManager.memoize.map.values()].filter((source) => source.spec?.upperVoxelBound)
      .filter(({ spec }) => spec.upperVoxelBound.every((n, i) => n - spec.lowerVoxelBound[i] === size[i])).flatMap((source) => [...source.chunks.values()]);
    return chunks.length > 0 && viewer.layerManager.managedLayers[0].isReady() && viewer.isReady();
  }, size, { timeout: 60000 });
}

// All that was decoded: the size and the chunks of each volume; for each chunk the place and size of its part inside the volume,
// and its cells (x fastest).
function decoded(page) {
  return page.evaluate(() => {
    const base64 = (data) => {
      const bytes = new Uint8Array(data.buffer);
      let text = "";
      for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
      return btoa(text);
    };
    const cut = ({ data, chunkDataSize: [nx, ny] }, [w, h, d]) => {
      const out = new data.constructor(w * h * d);
      for (let row = 0; row < h * d; ++row) {
        const from = (Math.floor(row / h) * ny + (row % h)) * nx;
        out.set(data.subarray(from, from + w), row * w);
      }
      return base64(out);
    };
    return [...viewer.dataContext.chunkManager.memoize.map.values()].filter((source) => source.spec?.upperVoxelBound).map(({ spec, chunks }) => {
      const volume = [...spec.upperVoxelBound].map((n, i) => n - spec.lowerVoxelBound[i]);
      return { size: volume, chunks: [...chunks.values()].filter((chunk) => chunk.data).map((chunk) => {
        const at = [...chunk.chunkGridPosition].map((c, i) => c * spec.chunkDataSize[i]);
        const size = [...chunk.chunkDataSize].map((n, i) => Math.min(n, volume[i] - at[i]));
        return { at, size, cells: cut(chunk, size) };
      }) };
    });
  });
}

// Compares a decoded chunk with the export of the level. Returns its number of cells.
function expect_chunk({ shape: [, ny, nx], data }, chunk, what) {
  const cells = new data.constructor(new Uint8Array(Buffer.from(chunk.cells, "base64")).buffer);
  const [x0, y0, z0] = chunk.at, [w, h, d] = chunk.size;
  for (let z = 0; z < d; ++z) {
    for (let y = 0; y < h; ++y) {
      const from = (z * h + y) * w, expected = ((z0 + z) * ny + y0 + y) * nx + x0;
      expect_same(cells.subarray(from, from + w), data.subarray(expected, expected + w), `${what}, row from cell ${[x0, y0 + y, z0 + z]}`);
    }
  }
  return w * h * d;
}

// The labelled cell that is nearest to the middle of the grid. Height counts most, since the stadium stands on wide ground.
function middle(grid, [nx, ny, nz]) {
  const { data } = exported(grid, 0);
  let best = [], least = Infinity;
  data.forEach((label, i) => {
    const cell = [i % nx, Math.floor(i / nx) % ny, Math.floor(i / nx / ny)];
    const distance = label ? Math.hypot(cell[0] - nx / 2, cell[1] - ny / 2, 8 * (cell[2] - nz / 2)) : Infinity;
    if (distance < least) [best, least] = [cell, distance];
  });
  return best;
}

// Cells on the three cross-sections through `at`, at most 150 cells from it. All of these are in view.
function cells_in_view(at, cells) {
  const places = [];
  for (let axis = 0; axis < 3; ++axis) {
    for (let i = 1; i <= 200; ++i) {
      // The fractional parts of multiples of these three fill a cube evenly.
      const place = at.map((a, d) => (d === axis ? a : a - 150 + Math.floor(((i * [0.8192, 0.671, 0.5497][d]) % 1) * 300)));
      if (place.every((p, d) => p >= 0 && p < cells[d])) places.push(place);
    }
  }
  return places;
}

const kSources = {
  precomputed: (grid) => `${server}/precomputed/${grid}/|neuroglancer-precomputed:`,
  zarr3: (grid) => `${server}/zarr/${grid}/labels/material/|zarr3:`,
  zarr2: (grid) => `${server}/zarr2/${grid}/|zarr2:`,
};

for (const [grid, info] of Object.entries(grids)) {
  for (const [protocol, source] of Object.entries(kSources)) {
    test(`${protocol}: ${grid}`, async () => {
      const cells = info.grid.cells, at = middle(grid, cells), space = space_of(info, protocol);
      const { shape: [, ny, nx], data } = exported(grid, 0);
      const label = ([x, y, z]) => data[(z * ny + y) * nx + x];
      const { page, errors } = await browser.open(`neuroglancer/neuroglancer.html#!${encodeURIComponent(JSON.stringify(state(grid, source(grid), space, at)))}`);
      await wait_for(page, cells);
      assert.ok((await screenshot(page, `neuroglancer-${protocol}-${grid}`)).length > 100, "the picture is blank");

      const places = cells_in_view(at, cells);
      assert.ok(places.length > 100);
      const told = await page.evaluate(({ places, first }) => {
        const { layer } = viewer.layerManager.managedLayers[0];
        return places.map((cell) => layer.getValueAt(Float32Array.from(cell, (c, i) => c + 0.5 + first[i]), { pickedRenderLayer: null }))
          .map((value) => Number(value?.key ?? value ?? -1));  // an object with the material's name when segments have properties
      }, { places, first: space.first });
      expect_same(told, places.map(label), "labels of cells in view");

      // The label under the mouse, in the middle of the first cross-section.
      const { x, y } = await page.evaluate(() => {
        const box = [...viewer.display.panels][0].element.getBoundingClientRect();
        return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
      });
      await page.mouse.move(x, y);
      const under = await page.waitForFunction(() => {
        const value = viewer.layerSelectedValues.get(viewer.layerManager.managedLayers[0].layer);
        return viewer.mouseState.updateUnconditionally() && value !== undefined && { position: [...viewer.mouseState.position], label: Number(value.value?.key ?? value.value) };
      });
      const { position, label: shown } = await under.jsonValue();
      const cell = position.map((p, i) => Math.floor(p - space.first[i]));
      assert.ok(cell.every((c, i) => Math.abs(c - at[i]) <= 1), `the mouse is on cell ${cell}, expected ${at}`);
      assert.equal(shown, label(cell));

      // The view is zoomed out through every level that the viewer knows. Then all that it has decoded is compared. (OME-Zarr lists
      // the levels down to the first that is a single block.)
      const many = protocol === "precomputed" ? info.levels.length : 1 + info.levels.findIndex((level) => Math.max(...level.cells) <= 64);
      for (const { level, cells: size } of info.levels.slice(1, many)) {
        await page.evaluate((scale) => (viewer.navigationState.zoomFactor.value = scale), 2 ** level * space.scale[0]);
        await wait_for(page, size);
      }
      const levels = new Map(info.levels.map((level) => [String(level.cells), level.level]));
      const compared = info.levels.slice(0, many).map(() => 0);
      for (const volume of await decoded(page)) {
        const level = levels.get(String(volume.size)), expected = exported(grid, level);
        for (const chunk of volume.chunks) compared[level] += expect_chunk(expected, chunk, `${protocol} ${grid} level ${level}`);
      }
      assert.ok(compared.every((n) => n > 0), `cells compared by level: ${compared}`);
      assert.deepEqual(errors, []);
      await page.close();
    });
  }
}
