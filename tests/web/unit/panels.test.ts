// Parts of the panels: ends of a box, distinct colours, addresses for other programs.
import assert from "node:assert/strict";
import test from "node:test";
import type { GridInfo } from "@page/base/grid";
import { initial_looks } from "@page/base/materials";
import { stats_csv, with_end } from "@page/panels/box_cells";
import { all_distinct, distinct_color, with_colors_of, with_distinct_colors } from "@page/panels/palette";
import { doors, neuroglancer_link, neuroglancer_state } from "@page/panels/share_links";
import type { Box } from "@page/state/viewer";

const materials = (...colors: string[]) => colors.map((color, id) => ({ id, name: String(id), color, rank: id }));

const box: Box = [10, 20, 30, 40, 50, 60];

test("an end of a box moves alone, stays in the grid, and pushes the other end before the box gets empty", () => {
  assert.deepEqual(with_end(box, 0, "low", 15, 100), [15, 20, 30, 40, 50, 60]);
  assert.deepEqual(with_end(box, 2, "high", 1000, 100), [10, 20, 30, 40, 50, 100]);
  assert.deepEqual(with_end(box, 1, "low", 70, 100), [10, 70, 30, 40, 71, 60]);
  assert.deepEqual(with_end(box, 1, "high", -5, 100), [10, 0, 30, 40, 1, 60]);
  assert.deepEqual(with_end(box, 0, "low", 1e9, 100), [99, 20, 30, 100, 50, 60]);
});

test("statistics as a table keep counts that no double holds", () => {
  const stats = {
    region: [...box] as Box,
    materials: [
      { id: 0, name: "air", cells: 2 ** 60, cells_text: "1152921504606846975", volume: 0.5, box: [...box] as Box },
      { id: 1, name: "a,b", cells: 0, volume: 0, box: null },
    ],
  };
  assert.equal(
    stats_csv(stats, "mm"),
    'id,material,cells,volume_mm3,x0,y0,z0,x1,y1,z1\n0,air,1152921504606846975,0.5,10,20,30,40,50,60\n1,"a,b",0,0,,,,,,\n',
  );
});

test("distinct colours are those that the mesher gives, and the background keeps its own", () => {
  assert.deepEqual([1, 2, 7, 8, 15].map(distinct_color), [
    [0x56, 0xb4, 0xe9], [0xe6, 0x9f, 0], [0, 0x72, 0xb2], [0x37, 0x75, 0x97], [0x22, 0x48, 0x5d],
  ]);
  // Beyond the mesher's 21 colours there are more, no two of them alike.
  const many = Array.from({ length: 49 }, (_, n) => distinct_color(n + 1));
  const apart = (a: number[], b: number[]) => Math.hypot(...a.map((c, i) => c - b[i]!));
  many.forEach((a, n) => many.slice(0, n).forEach((b, m) => assert.ok(apart(a, b) > 12, `${n + 1} and ${m + 1} are ${a} and ${b}`)));
  const own = initial_looks(materials("#00000000", "#ff0000", "#00ff0080"));
  assert.equal(all_distinct(own), false);
  const distinct = with_distinct_colors(own);
  assert.equal(all_distinct(distinct), true);
  assert.deepEqual(distinct[0], own[0]);
  assert.equal(distinct[2]!.opacity, own[2]!.opacity);
  assert.deepEqual(with_colors_of(distinct, own), own);
});

const uniform = (step: number) => ({ type: "uniform", min: 0, step, first: 0, cells: 10 });
const info = (axes: object[]) =>
  ({
    id: "a grid",
    units: "mm",
    grid: { axes, cells: [1000, 1000, 1000] },
    levels: [
      { level: 0, cells: [1000, 1000, 1000] },
      { level: 1, cells: [500, 500, 500] },
      { level: 2, cells: [250, 250, 250] },
    ],
  }) as unknown as GridInfo;
const looks = initial_looks(materials("#00000000", "#ff0000", "#0000ff"));

test("Neuroglancer is told the size of a cell in metres, and which materials are shown in which colours", () => {
  looks[2] = { ...looks[2]!, visible: false };
  const state = neuroglancer_state(info([uniform(0.5), uniform(0.5), uniform(1)]), "http://h:8080/base", [1, 2, 3], looks, 4);
  assert.deepEqual(state, {
    dimensions: { x: [0.0005, "m"], y: [0.0005, "m"], z: [0.001, "m"] },
    position: [1.5, 2.5, 3.5],
    crossSectionScale: 0.5,
    layers: [
      {
        type: "segmentation",
        name: "a grid",
        source: "precomputed://http://h:8080/base/precomputed/a%20grid",
        selectedAlpha: 1,
        notSelectedAlpha: 0,
        segments: ["1"],
        segmentColors: { 1: "#ff0000", 2: "#0000ff" },
      },
    ],
    layout: "4panel",
  });
  assert.deepEqual(JSON.parse(decodeURIComponent(neuroglancer_link(state).split("#!")[1]!)), state);
});

test("Neuroglancer shows the whole grid where no zoom is known yet", () => {
  const scale = (third: object) =>
    (neuroglancer_state(info([uniform(0.5), uniform(0.5), third]), "http://h", [1, 2, 3], looks, 0) as { crossSectionScale: number })
      .crossSectionScale;
  assert.equal(scale(uniform(1)), 2000 / 480); // cells of 0.5 per pixel: z is twice as long
  assert.equal(scale({ type: "graded", planes: [0, 1, 3] }), 1000 / 480);
});

test("Neuroglancer shows graded grids cell by cell", () => {
  const state = neuroglancer_state(info([uniform(0.5), uniform(0.5), { type: "graded", planes: [0, 1, 3] }]), "http://h", [1, 2, 0], looks, 4) as {
    dimensions: object;
  };
  assert.deepEqual(state.dimensions, { x: [1e-9, "m"], y: [1e-9, "m"], z: [1e-9, "m"] });
});

test("addresses have the server's base path and the grid's name as an address writes it", () => {
  for (const door of doors(info([uniform(1), uniform(1), uniform(1)]), "https://h/base", [5, 6, 7])) {
    assert.match(door.address, /^https:\/\/h\/base\/\w+\/.*a%20grid/);
    for (const address of (door.lines ?? "").match(/https?:[^"]*/g) ?? []) assert.match(address, /^https:\/\/h\/base\//);
  }
});
