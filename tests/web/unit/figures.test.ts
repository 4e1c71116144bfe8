// Figures: their sizes, their parts, and what is in their files.
import assert from "node:assert/strict";
import test from "node:test";
import { deflateSync } from "node:zlib";
import { joined } from "@page/figures/areas";
import { Axis } from "@page/base/axis";
import { laid_out, laid_out_together, planes_within, ticks_of } from "@page/figures/layout";
import { STANDARD, fault_of, pixels_of, points_of } from "@page/figures/options";
import { crc32, with_density } from "@page/figures/png";
import { uncover } from "@page/figures/slice_cells";
import { SvgSheet } from "@page/figures/svg_sheet";
import { random_of, whole } from "./random";

test("millimetres, inches and pixels are the same width at the same density", () => {
  const of = (width: number, unit: "mm" | "in" | "px") => pixels_of({ ...STANDARD, width, unit, dpi: 300 });
  assert.deepEqual([of(25.4, "mm"), of(1, "in"), of(300, "px")], [300, 300, 300]);
  assert.equal(points_of({ ...STANDARD, width: 2, unit: "in" }), 144);
});

test("what can't be made is said", () => {
  assert.equal(fault_of(STANDARD), null);
  assert.match(fault_of({ ...STANDARD, dpi: 5 })!, /36 to 2400/);
  assert.match(fault_of({ ...STANDARD, width: Number.NaN })!, /above 0/);
  assert.match(fault_of({ ...STANDARD, width: 1000, dpi: 2400 })!, /94488 pixels wide: 100 to 10000/);
  assert.equal(fault_of({ ...STANDARD, format: "svg", width: 1000, dpi: 2400 }), null, "shapes have no pixels");
  assert.match(fault_of({ ...STANDARD, format: "svg", width: 1e9 })!, /3\.5 metres/);
  assert.match(fault_of({ ...STANDARD, subject: "3d", format: "svg" })!, /choose PNG/);
});

test("lines stand at planes between cells that are large enough for them", () => {
  const graded = new Axis({ type: "graded", planes: [0, 10, 12, 12.5, 20, 40] }, 0.5);
  assert.deepEqual(planes_within(graded, { low: 0, high: 40 }, 80), [20, 40]);
  assert.deepEqual(planes_within(graded, { low: 0, high: 40 }, 400), [100, 120, 125, 200]);
  assert.deepEqual(planes_within(graded, { low: 11, high: 20 }, 90), [10, 15]);
  assert.deepEqual(planes_within(new Axis({ type: "uniform", min: 0, step: 1, first: 0, cells: 4 }, 0.5), { low: 0.5, high: 3.5 }, 30), [5, 15, 25]);
});

test("the checksum is that of PNG", () => {
  assert.equal(crc32(new TextEncoder().encode("IEND")), 0xae426082);
});

test("a PNG gets its density behind its head, and keeps all else", () => {
  const chunk = (name: string, data: Uint8Array) => {
    const out = new Uint8Array(12 + data.length);
    const view = new DataView(out.buffer);
    view.setUint32(0, data.length);
    out.set(new TextEncoder().encode(name), 4);
    out.set(data, 8);
    view.setUint32(8 + data.length, crc32(out.subarray(4, 8 + data.length)));
    return out;
  };
  const head = new Uint8Array([0, 0, 0, 1, 0, 0, 0, 1, 8, 6, 0, 0, 0]);
  const parts = [new Uint8Array([0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10]), chunk("IHDR", head), chunk("IDAT", deflateSync(new Uint8Array(5))), chunk("IEND", new Uint8Array(0))];
  const png = new Uint8Array(parts.flatMap((part) => [...part]));
  const dense = with_density(png, 300);
  assert.deepEqual([...dense.subarray(0, 33), ...dense.subarray(54)], [...png]);
  const view = new DataView(dense.buffer);
  assert.equal(view.getUint32(33), 9);
  assert.equal(new TextDecoder().decode(dense.subarray(37, 41)), "pHYs");
  assert.deepEqual([view.getUint32(41), view.getUint32(45), dense[49]], [11811, 11811, 1]); // 300 / 0.0254
  assert.equal(view.getUint32(50), crc32(dense.subarray(37, 50)));
});

test("over black and over white, a colour is found with its opacity", () => {
  for (const [color, alpha] of [[[200, 10, 90], 255], [[200, 10, 90], 128], [[0, 0, 0], 64], [[9, 9, 9], 0]] as const) {
    const over = (ground: number) => Uint8ClampedArray.from([...color.map((c) => (c * alpha + ground * (255 - alpha)) / 255), 255]);
    const [black, white] = [over(0), over(255)];
    uncover(black, white);
    assert.equal(white[3], alpha);
    if (alpha > 0) color.forEach((c, i) => assert.ok(Math.abs(white[i]! - c) <= 3, `${white} instead of ${color} ${alpha}`));
  }
});

test("rectangles cover each cell once, with its own colour, and columns of equal runs are one", () => {
  const random = random_of(5);
  for (let n = 0; n < 50; ++n) {
    const [width, height] = [whole(random, 1, 12), whole(random, 1, 12)];
    const cells = Array.from({ length: height }, () => Array.from({ length: width }, () => "abc"[whole(random, 0, n % 3)]!));
    const runs = cells.flatMap((row, v) =>
      row.flatMap((key, u) => {
        if (u > 0 && row[u - 1] === key) return [];
        let end = u + 1;
        while (row[end] === key) ++end;
        return [{ key, u0: u, u1: end, v0: v, v1: v + 1 }];
      }),
    );
    const found = cells.map((row) => row.map(() => ""));
    const areas = joined(runs, 1000)!;
    for (const [key, list] of areas)
      for (const { u0, u1, v0, v1 } of list) for (let v = v0; v < v1; ++v) for (let u = u0; u < u1; ++u) found[v]![u] += key;
    assert.deepEqual(found, cells);
    if (n % 3 === 0) assert.equal(areas.get("a")!.length, 1, "one colour is one rectangle");
  }
  assert.equal(joined([{ key: "a", u0: 0, u1: 1, v0: 0, v1: 1 }, { key: "b", u0: 1, u1: 2, v0: 0, v1: 1 }], 1), null);
});

test("a layout holds all its parts, true to scale", () => {
  const measure = (text: string) => 5 * text.length;
  const axes = [{ name: "x [m]", low: -150, high: 150 }, { name: "y [m]", low: 0, high: 60 }] as const;
  const layout = laid_out({ width: 480, aspect: 0.2, title: true, axes, bar: true, legend: Array.from({ length: 20 }, (_, i) => `material ${i}`) }, measure);
  assert.ok(Math.abs(layout.plot.height / layout.plot.width - 0.2) < 1e-12);
  assert.ok(layout.plot.x > 0 && layout.plot.x + layout.plot.width <= 480);
  assert.ok(layout.bar! > layout.names!.across + 8, "the scale bar stands below the axis");
  for (const { x, y, entry } of layout.legend) {
    assert.ok(y > layout.bar! + 6);
    assert.ok(x >= layout.plot.x && x + 12 + measure(`material ${entry}`) <= 480, `entry ${entry} at ${x}`);
    assert.ok(y > layout.plot.y + layout.plot.height && y < layout.height);
  }
  assert.ok(layout.across.length >= 3);
  for (const { at, text } of layout.across) assert.ok(Math.abs(-150 + 300 * at - Number(text.replace("−", "-"))) < 1e-9);
  assert.ok(layout.up.length >= 3, "a low picture has ticks as well");
  const bare = laid_out({ width: 480, aspect: 0.5, title: false, axes: null, bar: false, legend: [] }, measure);
  assert.deepEqual(bare.plot, { x: 0, y: 0, width: 480, height: 240 });
});

test("an axis has two numbers at least, however short it is, and may fall", () => {
  const random = random_of(9);
  for (let n = 0; n < 200; ++n) {
    const [low, high] = [200 * random() - 100, 200 * random() - 100];
    const found = ticks_of({ low, high }, 40 * random());
    assert.ok(found.length >= 2, `${low} to ${high}: ${found.map(({ text }) => text)}`);
    for (const { at, text } of found) assert.ok(at > -1e-6 && at < 1 + 1e-6 && Math.abs(low + at * (high - low) - Number(text.replace("−", "-"))) < 0.01 * Math.abs(high - low));
  }
});

test("an SVG document keeps text as text, whatever is in it", () => {
  const sheet = new SvgSheet(100, 50);
  sheet.text('a < b & "c"', 1, 2, { size: 8, color: "#000" });
  sheet.fill({ x: 0, y: 0, width: 1, height: 1 }, "rgb(1,2,3)", 0.25);
  sheet.areas([{ u0: 0, u1: 2, v0: 0, v1: 1 }], "rgb(1,2,3)", 0.5, (u, v) => [10 * u, 50 - 10 * v]);
  const text = sheet.document();
  assert.ok(text.includes('fill="rgb(1,2,3)" fill-opacity="0.25"/>'), "as SVG 1.1 has it");
  assert.ok(text.includes(">a &#60; b &#38; &#34;c&#34;</text>"));
  assert.ok(text.includes('<path fill="rgb(1,2,3)" fill-opacity="0.5" shape-rendering="crispEdges" d="M0 40H20V50H0Z"/>'), text);
});

test("panels of one sheet stand in rows of two, apart from each other and from the legend below them", () => {
  const measure = (text: string) => 5 * text.length;
  const axes = [{ name: "x [mm]", low: 0, high: 100 }, { name: "y [mm]", low: 0, high: 50 }] as const;
  const panels = [{ aspect: 0.5, axes, bar: true }, { aspect: 2, axes: null, bar: false }, { aspect: 0.2, axes, bar: true }, { aspect: 0.7, axes: null, bar: false }];
  const sheet = laid_out_together(panels, 480, true, ["steel", "gold"], measure);
  const boxes = sheet.panels.map(({ plot }) => plot);
  boxes.forEach((a, i) => {
    assert.ok(a.x >= 0 && a.x + a.width <= 480 && a.y > sheet.title! && Math.abs(a.height - a.width * panels[i]!.aspect) < 1e-9);
    assert.ok(sheet.panels[i]!.title! < a.y && sheet.panels[i]!.title! > (i < 2 ? sheet.title! : boxes[i - 2]!.y + boxes[i - 2]!.height));
    boxes.slice(i + 1).forEach((b) => assert.ok(a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y));
    for (const { y } of sheet.legend) assert.ok(y > a.y + a.height);
  });
  assert.equal(sheet.legend.length, 2);
  assert.ok(sheet.legend.every(({ y }) => y < sheet.height));
});
