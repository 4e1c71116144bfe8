// npm's openseadragon in Chromium: Deep Zoom and IIIF.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { open_browser, screenshot, server, slice_picture } from "./support.mjs";

let browser;
before(async () => (browser = await open_browser()));
after(() => browser.close());

// Shows a slice in an element of width x height pixels and waits until it is complete.
async function show(page, source, width, height) {
  await page.evaluate(async ({ source, width, height }) => {
    const element = document.getElementById("picture");
    element.style.cssText = `width: ${width}px; height: ${height}px; background: #fff`;
    window.viewer?.destroy();
    window.viewer = OpenSeadragon({ element, tileSources: source, crossOriginPolicy: "Anonymous", drawer: "canvas", imageSmoothingEnabled: false,
      showNavigationControl: false, animationTime: 0, blendTime: 0, visibilityRatio: 1 });
    window.asked = new Set();
    viewer.addHandler("tile-loaded", ({ tile }) => asked.add(tile.level));
    await new Promise((opened, failed) => {
      viewer.addHandler("open", opened);
      viewer.addHandler("open-failed", ({ message }) => failed(new Error(message)));
      viewer.addHandler("tile-load-failed", ({ tile, message }) => failed(new Error(`${tile.getUrl()}: ${message}`)));
    });
    const item = viewer.world.getItemAt(0);
    if (!item.getFullyLoaded()) await new Promise((loaded) => item.addOnceHandler("fully-loaded-change", loaded));
    viewer.forceRedraw();
    await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)));
  }, { source, width, height });
}

// Compares what OpenSeadragon has drawn with another picture: the size, and the number of pixels that differ. OpenSeadragon draws
// tiles without overlap one pixel wider and higher than they are, so that no gaps show. So a pixel may also equal a neighbour of
// the expected one, on the left or above.
function differences(page, picture) {
  return page.evaluate(async (url) => {
    const shown = viewer.drawer.canvas, { width, height } = shown;
    const expected = await createImageBitmap(await (await fetch(url)).blob());
    const context = new OffscreenCanvas(expected.width, expected.height).getContext("2d");
    context.drawImage(expected, 0, 0);
    if (width !== expected.width || height !== expected.height) return { width, height };
    const a = new Uint32Array(shown.getContext("2d").getImageData(0, 0, width, height).data.buffer);
    const b = new Uint32Array(context.getImageData(0, 0, width, height).data.buffer);
    let wrong = 0, moved = 0;
    a.forEach((pixel, i) => {
      if (pixel === b[i]) return;
      ++moved;
      const left = i % width ? 1 : 0, up = i >= width ? width : 0;
      if (pixel !== b[i - left] && pixel !== b[i - up] && pixel !== b[i - left - up]) ++wrong;
    });
    return { width, height, wrong, moved: moved / a.length };
  }, `data:image/png;base64,${picture.toString("base64")}`);
}

for (const [grid, axis, index, width, height] of [["parts", "z", 4, 1301, 701], ["stadium", "z", 20, 301, 241], ["stadium", "y", 120, 301, 61]]) {
  for (const [protocol, source] of [["dzi", `${server}/dzi/${grid}/${axis}/${index}.dzi`], ["iiif", `${server}/iiif/${grid}-${axis}-${index}/info.json`]]) {
    test(`${protocol}: the slice ${axis} = ${index} of ${grid}`, async () => {
      const { page, errors } = await browser.open("openseadragon.html");
      await show(page, source, width, height);
      const { moved, ...rest } = await differences(page, slice_picture(grid, axis, index));
      assert.deepEqual(rest, { width, height, wrong: 0 });
      assert.ok(moved < 0.1, `${100 * moved} % of the pixels are a neighbour's`);
      assert.ok((await screenshot(page, `openseadragon-${protocol}-${grid}-${axis}`)).length >= 3, "the picture is blank");

      await show(page, source, Math.ceil(width / 4), Math.ceil(height / 4));
      if (protocol === "dzi" || width > 512) {  // where there are smaller tiles
        const [coarsest, finest] = await page.evaluate(() => [Math.min(...asked), viewer.source.maxLevel]);
        assert.ok(coarsest < finest, "only the finest tiles were asked for");
      }
      assert.ok((await screenshot(page, `openseadragon-${protocol}-${grid}-${axis}-small`)).length >= 3, "the small picture is blank");
      assert.deepEqual(errors, []);
      await page.close();
    });
  }
}
