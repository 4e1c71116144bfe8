// What is seen, as numbers, is decoded and coloured: layers lie over each other from far to near, and edges are means.
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Palette, type Substance, VEILS, compose, cover_of } from "@page/overview/sight/compose";
import { empty_frame, point_at, put_part } from "@page/overview/frame";
import type { LabelLook } from "@page/base/materials";
import { layers_of, palette_of } from "@page/overview/sight/layers";
import { type Sights, decode_sights } from "@page/overview/sight/sights";
import { fitted, project, projection_of } from "@page/overview/space/camera";

// As server/SERVING.md has it. `pixels`: label plus 1, the code of the distance, own, added and facing light.
function encoded(width: number, pixels: readonly (readonly number[])[], edges: Record<number, readonly (readonly number[])[]> = {}, wide = 1): ArrayBuffer {
  const n = pixels.length;
  const out: number[] = [..."TCS1"].map((c) => c.charCodeAt(0));
  const u32 = (x: number) => out.push(x & 255, (x >> 8) & 255, (x >> 16) & 255, x >>> 24);
  const f64 = (x: number) => out.push(...new Uint8Array(Float64Array.of(x).buffer));
  const label = (x: number) => {
    for (let i = 0; i < wide; ++i) out.push((x >> (8 * i)) & 255);
  };
  u32(width);
  u32(n / width);
  u32(Object.keys(edges).length);
  f64(2);
  f64(8);
  u32(wide);
  u32(0);
  for (const p of pixels) label(p[0]!);
  const step = (i: number, part: number) => pixels[i]![part]! - (i % width === 0 ? 0 : pixels[i - 1]![part]!);
  for (const shift of [0, 8]) for (let i = 0; i < n; ++i) out.push((step(i, 1) >> shift) & 255);
  for (const part of [2, 3, 4]) for (let i = 0; i < n; ++i) out.push(step(i, part) & 255);
  for (let at = 0; at < n; at += 8) {
    let byte = 0;
    for (let i = at; i < Math.min(n, at + 8); ++i) if (i in edges) byte |= 1 << (i - at);
    out.push(byte);
  }
  const points = Object.values(edges).flat();
  for (const p of points) label(p[0]!);
  for (const part of [2, 3, 4]) for (const p of points) out.push(p[part]!);
  return Uint8Array.from(out).buffer;
}

const NOTHING = [0, 0, 0, 0, 0];

test("numbers are read back: labels of one, two and four bytes, distances by their logarithm, differences along rows", () => {
  for (const wide of [1, 2, 4]) {
    const label = wide === 1 ? 200 : 60_000;
    const pixels = [[label, 1, 250, 3, 9], [1, 65535, 7, 200, 255], NOTHING, [2, 32768, 100, 0, 0], NOTHING, NOTHING];
    const sights = decode_sights(encoded(3, pixels, { 3: [[label, 0, 1, 2, 3], [0, 0, 0, 0, 0], [1, 0, 4, 5, 6], [1, 0, 7, 8, 9]] }, wide), 10);
    assert.deepEqual([sights.width, sights.height], [3, 2]);
    assert.deepEqual([...sights.label], pixels.map((p) => p[0]));
    assert.deepEqual([...sights.own], pixels.map((p) => p[2]));
    assert.deepEqual([...sights.added], pixels.map((p) => p[3]));
    assert.deepEqual([...sights.facing], pixels.map((p) => p[4]));
    assert.deepEqual([...sights.far].map((x) => Number(x.toFixed(2))), [20, 80, 0, 40, 0, 0]);
    assert.deepEqual([...sights.edges.at], [3]);
    assert.deepEqual([...sights.edges.label], [label, 0, 1, 1]);
    assert.deepEqual([...sights.edges.facing], [3, 0, 6, 9]);
  }
});

test("without perspective distances are steps of equal length, and the nearest may be at 0", () => {
  const pixels = encoded(3, [[1, 1, 0, 0, 0], [1, 32768, 0, 0, 0], NOTHING]);
  assert.deepEqual([...decode_sights(pixels, 10, false).far].map((x) => Number(x.toFixed(2))), [20, 50, 0]);
  new DataView(pixels).setFloat64(16, 0, true);
  assert.ok(decode_sights(pixels, 10, false).far[0]! > 0);
});

test("bytes that are cut short, or something else, are refused", () => {
  const whole = encoded(2, [[1, 1, 1, 1, 1], NOTHING], {});
  assert.throws(() => decode_sights(whole.slice(0, whole.byteLength - 1), 1), /expected 53 bytes, found 52/);
  assert.throws(() => decode_sights(new ArrayBuffer(100), 1), /TCS1/);
  assert.throws(() => decode_sights(new ArrayBuffer(0), 1), /TCS1/);
});

const palette = (opacity: readonly number[], substance: Substance = "clear"): Palette => ({
  squares: Float32Array.from(opacity.flatMap((_, label) => [label === 0 ? 1 : 0, label === 1 ? 1 : 0, label === 2 ? 1 : 0])),
  opacity: Float32Array.from(opacity),
  veil: new Uint8Array(opacity.length).fill(VEILS.indexOf(substance)),
  damaged: opacity.length,
});
const sights_of = (pixels: readonly (readonly number[])[], edges = {}): Sights => decode_sights(encoded(pixels.length, pixels, edges), 1);
const pixel = (pixels: Uint8Array, i: number) => [...pixels.subarray(4 * i, 4 * i + 4)];

test("a colour is the label's own light and what is added to it; an edge is the mean of its four points", () => {
  const seen = sights_of([[1, 1, 160, 0, 255], [2, 1, 40, 0, 255], NOTHING, [1, 1, 160, 0, 255]], {
    3: [[1, 0, 160, 0, 255], [2, 0, 160, 0, 255], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0]],
  });
  const { pixels, label } = compose([seen], palette([1, 1, 1]));
  assert.deepEqual(pixel(pixels, 0), [255, 0, 0, 255]);
  assert.deepEqual(pixel(pixels, 1), [0, 128, 0, 255]);
  assert.deepEqual(pixel(pixels, 2), [0, 0, 0, 0]);
  assert.deepEqual(pixel(pixels, 3), [64, 64, 0, 128]);
  assert.deepEqual([...label], [1, 2, 0, 1]);
});

test("what is clear shows what is behind it, and hides nothing when it is farther away", () => {
  const opaque = sights_of([[1, 30000, 160, 0, 255], [1, 30000, 160, 0, 255], NOTHING]);
  const clear = sights_of([[2, 20000, 160, 0, 255], [2, 40000, 160, 0, 255], [2, 1, 160, 0, 255]]);
  const { pixels, label, far } = compose([opaque, clear], palette([1, 0.5]));
  assert.deepEqual(pixel(pixels, 0), [127, 128, 0, 255]);
  assert.deepEqual(pixel(pixels, 1), [255, 0, 0, 255]);
  assert.deepEqual(pixel(pixels, 2), [0, 128, 0, 128]);
  assert.deepEqual([...label], [2, 1, 2]);
  assert.ok(far[0]! < far[1]!);
});

test("glass is clearest where it faces the eye, and what is faint is clearer than that", () => {
  const facing_and_glancing = (substance: Substance) => {
    const { pixels } = compose([sights_of([[1, 1, 160, 0, 255], [1, 1, 160, 0, 0]])], palette([1], substance));
    return [pixels[3]!, pixels[7]!] as const;
  };
  const [glass, faint] = [facing_and_glancing("glass"), facing_and_glancing("faint")];
  assert.ok(glass[0] < glass[1] && faint[0] < faint[1], "edges are not seen best");
  assert.ok(faint[0] < glass[0] / 4 && faint[1] < glass[1] / 2);
});

test("glass keeps its hue where it faces the eye, on light and on dark ground, and lets half of what is behind it through", () => {
  const hue_and_chroma = ([r, g, b]: readonly number[]) => {
    const [x, y] = [r! - (g! + b!) / 2, (Math.sqrt(3) / 2) * (g! - b!)];
    return { hue: (Math.atan2(y, x) * 180) / Math.PI, chroma: Math.hypot(x, y) };
  };
  const cover = cover_of("glass", 1);
  assert.ok(cover <= 0.5);
  for (const ground of [[255, 255, 255], [243, 245, 248], [26, 32, 41], [17, 21, 28]]) // the middle and the edge of both themes
    for (const own of [[213, 94, 0], [86, 180, 233], [0, 158, 115], [240, 228, 66], [204, 121, 167], [91, 100, 112]]) {
      const seen = hue_and_chroma(own.map((c, i) => cover * c + (1 - cover) * ground[i]!));
      const wanted = hue_and_chroma(own);
      const turned = Math.abs(((seen.hue - wanted.hue + 540) % 360) - 180);
      assert.ok(seen.chroma > 0.35 * wanted.chroma && turned < 25, `${own} on ${ground}: ${seen.chroma / wanted.chroma}, turned by ${turned}`);
    }
});

test("opaque materials share a layer, clear ones have one each as long as they are few, and hidden ones have none", () => {
  const look = (material: number, opacity: number, visible = true): LabelLook => ({ color: [0, 0, 0], material, opacity, visible });
  const sight = (looks: readonly LabelLook[], mode: "whole" | "glass" | "cut", small: readonly number[] = []) => ({ looks, mode, small: new Set(small) });
  const looks = [look(0, 0), look(1, 1), look(2, 0.5), look(3, 1, false), look(4, 1)];
  assert.deepEqual(layers_of(sight(looks, "whole")), [[1, 4], [2]]);
  assert.deepEqual(layers_of(sight(looks, "glass")), [[1], [2], [4]]);
  assert.deepEqual(layers_of(sight(looks, "glass", [0, 2, 3, 4])), [[4], [1], [2]], "what is small is solid in glass, unless people made it clear");
  const around = looks.map((l, label) => ({ ...l, faint: label !== 4 }));
  for (const mode of ["whole", "glass"] as const) assert.deepEqual(layers_of(sight(around, mode)), [[4], [1, 2]], "all that is faint is one layer");
  const bodies = [look(0, 0), look(1, 1), look(1, 1), look(2, 0.5), look(2, 0.5)];
  assert.deepEqual(layers_of(sight(bodies, "whole")), [[1, 2], [3, 4]], "bodies of one material are one layer");
  assert.deepEqual(layers_of(sight(bodies.map((b, label) => ({ ...b, visible: label !== 1 && label !== 4 })), "whole")), [[2], [3]]);
  assert.deepEqual(layers_of(sight(bodies.map((b, label) => ({ ...b, opacity: label === 1 ? 0.5 : b.opacity })), "whole")), [[2], [1], [3, 4]], "a clear body");
  const many = Array.from({ length: 20 }, (_, i) => look(i, 0.5));
  const layers = layers_of(sight(many, "whole"));
  assert.equal(layers.length, 7);
  assert.deepEqual(layers.flat(), many.map((_, i) => i));
  assert.deepEqual([...palette_of(sight(looks.slice(0, 3), "cut")).opacity], [0, 1, 0.5, 1, 1], "what can't be read is opaque");
});

test("a frame is put together from parts, and a pixel's point is seen at that pixel", () => {
  const orbit = fitted([1, 0.7, 0.4], 30, 20, 2);
  const frame = empty_frame(orbit, 8, 4);
  assert.equal(point_at(frame, 5, 2), null);
  put_part(frame, { width: 2, height: 1, pixels: Uint8Array.from([1, 2, 3, 4, 5, 6, 7, 8]), far: Float32Array.of(1.5, 0), label: Uint32Array.of(9, 0) }, 5, 2);
  assert.deepEqual([...frame.pixels.subarray(4 * 21, 4 * 23)], [1, 2, 3, 4, 5, 6, 7, 8]);
  assert.equal(frame.label[21], 9);
  const seen = project(projection_of(orbit, 8, 4), point_at(frame, 5, 2)!);
  assert.ok(Math.abs(seen.x - 5.5) < 1e-9 && Math.abs(seen.y - 2.5) < 1e-9 && Math.abs(seen.far - 1.5) < 1e-9);
  assert.equal(point_at(frame, 6, 2), null);
});
