// The grids that are served, with pictures; or why there is none to see.
import { useEffect, useState } from "preact/hooks";
import { AXIS_NAMES, type AxisIndex, type GridInfo, type GridSummary, get } from "./api";
import { use_answer } from "./answer";
import { CopyButton } from "./copy";
import { about, bytes_text, grouped, product, significant, sizes } from "./format";
import { grids } from "./page";
import { FRAMES } from "./axis";

const PICTURE = 360; // cells: a level that is about as fine as the picture on the card

// Pictures come like everything else, so that a token goes along.
function Preview({ grid, axis }: { grid: GridSummary; axis: AxisIndex }) {
  const [url, set_url] = useState<string | null>(null);
  const [failed, set_failed] = useState(false);
  const frame = FRAMES[axis];
  let level = 0;
  while (Math.max(grid.cells[frame.u], grid.cells[frame.v]) / 2 ** level > PICTURE) ++level;
  const index = Math.floor(grid.cells[axis] / 2 / 2 ** level);
  const path = `api/v1/grids/${encodeURIComponent(grid.id)}/slice/${AXIS_NAMES[axis]}/${index}.png?level=${level}&v=${grid.hash}`;
  useEffect(() => {
    const abort = new AbortController();
    let made: string | null = null;
    get(path, { signal: abort.signal, priority: "low" })
      .then((r) => r.blob())
      .then((blob) => set_url((made = URL.createObjectURL(blob))))
      .catch(() => abort.signal.aborted || set_failed(true));
    return () => {
      abort.abort();
      if (made) URL.revokeObjectURL(made);
    };
  }, [path]);
  return <span class="preview">{url ? <img src={url} alt={`${grid.id}: slice across ${AXIS_NAMES[axis]} in the middle`} /> : failed && <span class="faint">no picture</span>}</span>;
}

function Materials({ grid }: { grid: GridSummary }) {
  const info = use_answer<GridInfo>(`api/v1/grids/${encodeURIComponent(grid.id)}?v=${grid.hash}`).value;
  if (!info) return <p class="card-facts">&nbsp;</p>;
  const size = info.grid.max.map((high, d) => significant(high - info.grid.min[d]!, 4)).join(" × ");
  const shown = info.materials.slice(1, 7);
  return (
    <p class="card-facts">
      <span>
        {size} {info.units}
      </span>
      <span class="card-materials">
        {shown.map((m) => (
          <span key={m.id} class="material-name">
            <span class="swatch" style={{ background: m.color }} />
            {m.name}
          </span>
        ))}
        {info.materials.length > 7 && <span class="faint">and {grouped(info.materials.length - 7)} more</span>}
      </span>
    </p>
  );
}

function Card({ grid }: { grid: GridSummary }) {
  const root = new URL(".", location.href.split("#")[0]).href;
  const id = encodeURIComponent(grid.id);
  const addresses: readonly (readonly [string, string])[] = [
    ["JSON", `api/v1/grids/${id}`],
    ["Zarr 3, OME-Zarr", `zarr/${id}`],
    ["Zarr 2", `zarr2/${id}`],
    ["xarray", `xarray/${id}/0`],
    ["Neuroglancer", `precomputed/${id}`],
    ["Deep Zoom", `dzi/${id}/z/${Math.floor(grid.cells[2] / 2)}.dzi`],
    ["IIIF", `iiif/${id}-z-${Math.floor(grid.cells[2] / 2)}/info.json`],
  ];
  return (
    <li class="card">
      <a class="card-main" href={`#g=${id}`}>
        <span class="previews">
          {([2, 1, 0] as const).map((axis) => (
            <Preview key={axis} grid={grid} axis={axis} />
          ))}
        </span>
        <h2>{grid.name}</h2>
        <p class="card-facts">
          <span>{sizes(grid.cells)}</span>
          <span>
            <b>{about(product(grid.cells))}</b> cells
          </span>
          <span>{bytes_text(grid.bytes)}</span>
        </p>
        <Materials grid={grid} />
      </a>
      <details>
        <summary>Addresses for other programs</summary>
        <table class="addresses">
          <tbody>
            {addresses.map(([name, path]) => (
              <tr key={name}>
                <th scope="row">{name}</th>
                <td>
                  <code>{root + path}</code>
                </td>
                <td>
                  <CopyButton text={root + path} what={`the address for ${name}`} />
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      </details>
    </li>
  );
}

export function StartPage({ waiting, trouble }: { waiting: string | null; trouble: string | null }) {
  const list = grids.value;
  if (waiting || (list === null && !trouble)) return <main class="start" aria-busy="true" aria-label={waiting ? `Opening ${waiting}` : "Looking for grids"} />;
  return (
    <main class="start">
      {trouble && (
        <p class="problem start-trouble" role="alert">
          {trouble}
        </p>
      )}
      {list?.length === 0 && (
        <div class="empty">
          <h1>No grid here yet</h1>
          <p>
            The server runs, but serves no grid. Make one, and put it into the folder that is served: it appears here by itself.
          </p>
          <pre>teracell mesh part.stl --cells 2000 -o part.tcell</pre>
        </div>
      )}
      {list && list.length > 0 && (
        <>
          <h1>{list.length === 1 ? "One grid" : `${grouped(list.length)} grids`}</h1>
          <ul class="cards">
            {list.map((grid) => (
              <Card key={grid.id} grid={grid} />
            ))}
          </ul>
        </>
      )}
    </main>
  );
}
