// The grid's addresses for other programs, with the lines that open it there. tests/clients/snippets_test.mjs runs all
// of these lines.
import type { GridInfo, Index3 } from "../base/grid";
import { METRES } from "../base/lengths";
import { type MaterialLook, hex_color } from "../base/materials";

export interface Door {
  name: string; // of the program
  address: string;
  language: "python" | "javascript" | "html" | "shell";
  lines: string | null; // what to type there
  packages: readonly string[]; // of Debian or, for pages, of npm, that the lines need
  note?: string;
}

// Whether an address leads to the machine alone on which it is opened.
export const is_loopback = (hostname: string): boolean => /^(localhost|.+\.localhost|127(\.\d+){3}|\[::1\])$/.test(hostname);

export const NEUROGLANCER = "https://neuroglancer-demo.appspot.com";
const IN_PAGES = "for pages of other sites, start the server with --allow-origin";
const FITTED = 480; // pixels for the longest side when no zoom is known, as in the layout with the overview alone
const MOST_CELLS = 256 ** 3; // of the level that the lines ask for, so that it comes at once

// `root` is the server's address with its base path and without a '/' at its end. `cell` is of level 0.
export function doors(info: GridInfo, root: string, cell: Index3): Door[] {
  const id = encodeURIComponent(info.id);
  const level = info.levels.find((l) => l.cells.reduce((a, b) => a * b, 1) <= MOST_CELLS)?.level ?? info.levels.length - 1;
  const at = (n: number) => Math.floor(n / 2 ** level);
  const [x, y, z] = cell;
  const zarr3 = `${root}/zarr/${id}`;
  const zarr2 = `${root}/zarr2/${id}`;
  const xarray = `${root}/xarray/${id}/${level}`;
  const dzi = `${root}/dzi/${id}/z/${z}.dzi`;
  const api = `${root}/api/v1/grids/${id}`;
  const python = { language: "python" } as const;
  return [
    {
      ...python,
      name: "Python: zarr",
      address: zarr2,
      lines: `import zarr\ncells = zarr.open("${zarr2}", mode="r")["${level}"][${at(z)}]  # [y, x] of level ${level}`,
      packages: ["python3-zarr", "python3-fsspec", "python3-aiohttp"],
      note: "Zarr v2",
    },
    {
      ...python,
      name: "Python: xarray",
      address: xarray,
      lines: `import xarray\nlabel = xarray.open_zarr("${xarray}").label`,
      packages: ["python3-xarray", "python3-zarr", "python3-fsspec", "python3-aiohttp"],
      note: `with coordinates, also those of graded grids; level ${level}`,
    },
    {
      ...python,
      name: "Python: dask",
      address: `${zarr2}/${level}`,
      lines: `import dask.array\ncounts = dask.array.bincount(dask.array.from_zarr("${zarr2}/${level}").ravel()).compute()`,
      packages: ["python3-dask", "python3-zarr", "python3-fsspec", "python3-aiohttp"],
      note: `counts the cells of every material on level ${level}`,
    },
    {
      ...python,
      name: "ParaView",
      address: xarray,
      lines: `import xarray\nxarray.open_zarr("${xarray}").label.astype("int16").to_netcdf("grid.nc")`,
      packages: ["python3-xarray", "python3-zarr", "python3-fsspec", "python3-aiohttp", "python3-netcdf4"],
      note: "writes a file that ParaView opens",
    },
    {
      language: "javascript",
      name: "JavaScript: zarrita",
      address: zarr3,
      lines: [
        `import * as zarr from "zarrita";`,
        `const array = await zarr.open(new zarr.FetchStore("${zarr3}/${level}"), { kind: "array" });`,
        `const cells = await zarr.get(array, [${at(z)}, null, null]);`,
      ].join("\n"),
      packages: ["zarrita"],
      note: `Zarr v3, OME-Zarr 0.5; for an ES module (in Node.js a file .mjs); ${IN_PAGES}`,
    },
    {
      language: "html",
      name: "OpenSeadragon (Deep Zoom)",
      address: dzi,
      lines: `OpenSeadragon({ id: "view", tileSources: "${dzi}" });`,
      packages: ["openseadragon"],
      note: `the slice across z at the crosshair, for an element with the id “view”; ${IN_PAGES}`,
    },
    { language: "html", name: "IIIF viewers", address: `${root}/iiif/${id}-z-${z}/info.json`, lines: null, packages: [], note: `the same slice; ${IN_PAGES}` },
    {
      language: "shell",
      name: "curl",
      address: api,
      packages: ["curl"],
      lines: [
        `curl -s "${api}/column/z/${x}_${y}"  # the runs along z through the crosshair`,
        `curl -so slice.png "${api}/slice/z/${at(z)}.png?level=${level}"`,
      ].join("\n"),
    },
  ];
}

// The state that Neuroglancer opens. There, precomputed volumes begin at 0, and graded grids are shown cell by cell.
export function neuroglancer_state(info: GridInfo, root: string, cell: Index3, looks: readonly MaterialLook[], pixels_a_unit: number): object {
  const metres = METRES[info.units];
  const steps = info.grid.axes.map((axis) => (axis.type === "uniform" ? axis.step : null));
  const index = metres === undefined || steps.some((s) => s === null);
  const scale = (d: number): [number, string] => [index ? 1e-9 : steps[d]! * metres!, "m"];
  const shown = looks.flatMap((look, id) => (id > 0 && look.visible ? [String(id)] : []));
  // Cells per pixel. Neuroglancer counts in cells of the smallest step.
  const smallest = index ? 1 : Math.min(...steps.map((s) => s!));
  const fitted = Math.max(...info.grid.cells.map((n, d) => (index ? n : (n * steps[d]!) / smallest))) / FITTED;
  return {
    dimensions: { x: scale(0), y: scale(1), z: scale(2) },
    position: cell.map((c) => c + 0.5),
    crossSectionScale: pixels_a_unit === 0 ? fitted : index ? 1 : 1 / (pixels_a_unit * smallest),
    layers: [
      {
        type: "segmentation",
        name: info.id,
        source: `precomputed://${root}/precomputed/${encodeURIComponent(info.id)}`,
        selectedAlpha: 1,
        notSelectedAlpha: 0,
        segments: shown,
        segmentColors: Object.fromEntries(looks.slice(1).map((look, n) => [String(n + 1), hex_color(look)])),
      },
    ],
    layout: "4panel",
  };
}

export const neuroglancer_link = (state: object): string => `${NEUROGLANCER}/#!${encodeURIComponent(JSON.stringify(state))}`;
