// The address holds the whole state: it is read back as it was written, and nonsense in it does no harm.
import assert from "node:assert/strict";
import test from "node:test";
import type { GridInfo } from "@page/base/grid";
import { address_of, read_address } from "@page/state/permalink";
import { places_found } from "@page/state/places";
import { put_measure } from "@page/state/measures";
import { Viewer } from "@page/state/viewer";

const info = {
  id: "a grid & more",
  units: "mm",
  ray_axis: "z",
  grid: {
    min: [0, -1, 0],
    max: [10, 1, 7],
    cells: [100, 20, 7],
    sample: [0.5, 0.5, 0.5],
    axes: [
      { type: "uniform", min: 0, step: 0.1, first: 0, cells: 100 },
      { type: "uniform", min: -1, step: 0.1, first: 0, cells: 20 },
      { type: "graded", planes: [0, 1, 2, 3, 4, 5, 6, 7] },
    ],
    cells_text: "14000",
  },
  materials: [
    { id: 0, name: "air", color: "#00000000", rank: 0 },
    { id: 1, name: "steel", color: "#8899aa", rank: 1 },
  ],
  levels: [],
  file: { bytes: 1, version: "1.0", hash: "0" },
  crossings: 0,
  bits_per_crossing: 0,
  report: {
    bodies: [
      {
        name: "tin",
        facets: 1,
        degenerate: 0,
        duplicates: 0,
        shells: 1,
        fill: [],
        holes: [{ at: [1, 0, 1], edges: 3, diameter: 1, cap_area: 1 }],
        flips: [],
        cells: 1,
      },
    ],
    crossings: 0,
    warnings: [],
    inputs: [],
  },
} as unknown as GridInfo;

function read(address: string): Viewer {
  (globalThis as { location?: unknown }).location = { hash: address };
  const viewer = new Viewer(info);
  read_address(viewer);
  return viewer;
}

function changed(): Viewer {
  const v = new Viewer(info);
  v.cell.value = [3, 19, 0];
  v.centre.value = [0.1 + 0.2, -1 / 3, 1e-7];
  v.zoom.value = Math.PI;
  v.layout.value = "x";
  v.panel.value = null;
  v.show_axes.value = false;
  v.show_outline.value = true;
  v.show_leaves.value = true;
  v.refinement.value = { coarsest: 5, layers: 3, want: "inside:steel=1,box:0,0,0,1,1,1=0" };
  v.box.value = [1, 2, 3, 4, 5, 6];
  v.pinned.value = [9, 8, 6];
  put_measure(v, { id: 1, name: "", axis: 1, from: [0.1, 0.2, 0.3], to: [1, 2, 3] });
  put_measure(v, { id: 2, name: "wide; or 50:50 %, ünlike", axis: null, from: [0.1, 0.2, 0.3], to: [-1e-9, 2, 3] });
  v.markers.value = places_found(info);
  v.isolated.value = { labels: [1], box: [1, 2, 3, 4, 5, 6] };
  v.sky.value = 1;
  v.looks.value = [
    { color: [1, 2, 255], visible: true, opacity: 0.25 },
    { color: [0x88, 0x99, 0xaa], visible: false, opacity: 1 },
  ];
  return v;
}

test("a changed state is read back completely, to the last bit of its numbers", () => {
  const before = changed();
  const after = read(address_of(before));
  for (const name of [
    "cell", "centre", "zoom", "layout", "panel", "show_axes", "show_scale", "show_lines", "show_outline", "show_leaves", "refinement", "box", "pinned", "measures", "markers",
    "looks", "isolated", "sky",
  ] as const)
    assert.deepEqual(after[name].value, before[name].value, name);
  assert.equal(address_of(after), address_of(before));
  assert.equal(new URLSearchParams(address_of(before).slice(1)).get("g"), info.id);
});

test("the address does not hold what is as at the start", () => {
  const address = address_of(new Viewer(info));
  assert.deepEqual([...new URLSearchParams(address.slice(1)).keys()], ["g", "at", "look"]);
});

test("nonsense is ignored, piece by piece", () => {
  const start = new Viewer(info);
  for (const nonsense of [
    "#",
    "#at=1,2",
    "#at=a,b,c",
    "#zoom=-1",
    "#zoom=0",
    "#look=1,NaN,2",
    "#layout=five",
    "#panel=nothing",
    "#axes=2",
    "#refine=17,2",
    "#refine=3,0",
    "#refine=3",
    "#box=1",
    "#box=0,0,0,100,20,8",
    "#box=5,0,0,5,20,7",
    "#box=0,0,-1,5,20,7",
    "#box=0,0,0,5.5,20,7",
    "#pin=1,2",
    "#pin=1,2,3.5",
    "#measure=7,0,0,0,1,1,1",
    "#measure=1,0,0,0,1,1",
    "#measure=1,0,0,0,1,1,",
    "#measure=;:;",
    "#only=",
    "#only=9",
    "#only=&found=5,0,0,5,20,7",
    "#up=x",
    "#material=9:ffffff:1:1;1:red:1:1;1:ffffff:2:1",
    "#at=,,&zoom=",
    "#%",
    "#compare=",
    "#across=x&mode=wipe&wipe=0.3&together=0&apart=5",
  ])
    assert.equal(address_of(read(nonsense)), address_of(start), nonsense);
  assert.deepEqual(read("#at=5,5,5&layout=five").cell.value, [5, 5, 5]);
  assert.deepEqual(read("#at=500,-5,3").cell.value, [99, 0, 3]); // moved into the grid
});

test("a comparison is read back; of what makes no sense in it, the rest is taken", () => {
  const before = new Viewer(info);
  before.compare.value = { other: "b & c", axis: 1, space: true, mode: "wipe", wipe: 0.25, together: false, apart: -1 / 3 };
  before.centre.value = [-50, 0, 0]; // in the other grid
  const after = read(address_of(before));
  assert.deepEqual(after.compare.value, before.compare.value);
  assert.deepEqual(after.centre.value, before.centre.value);
  const start = { other: "b", axis: 2, space: false, mode: "side", wipe: 0.5, together: true, apart: 0 };
  assert.deepEqual(read("#compare=b").compare.value, start);
  assert.deepEqual(read("#compare=b&across=w&mode=all&wipe=2&together=&apart=far").compare.value, { ...start, together: false });
  const plain = new Viewer(info);
  plain.compare.value = start as never;
  assert.deepEqual([...new URLSearchParams(address_of(plain).slice(1)).keys()], ["g", "at", "look", "compare"]);
});
