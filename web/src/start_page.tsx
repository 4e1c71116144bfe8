// The list of the grids that are served, with pictures, or why there is nothing to show.
import { Axis } from "./base/axis";
import { about, bytes_text, grouped, noun, plural, product, significant, sizes, unit_name } from "./base/format";
import type { GridInfo, GridSummary, UnreadableFile } from "./base/grid";
import { grids, unreadable } from "./page";
import { Preview } from "./preview";
import { use_answer } from "./server/answer";
import { server_root } from "./server/api";
import { CopyButton } from "./widgets/copy";
import { Icon } from "./widgets/icons";

function Previews({ grid, info }: { grid: GridSummary; info: GridInfo | null }) {
  const axes = info?.grid.axes.map((axis, d) => new Axis(axis, info.grid.sample[d]!));
  return (
    <span class="previews">
      {([2, 1, 0] as const).map((axis) => (axes ? <Preview key={axis} grid={grid} axes={axes} axis={axis} /> : <span key={axis} class="preview" />))}
    </span>
  );
}

function Materials({ info }: { info: GridInfo | null }) {
  if (!info) return <p class="card-facts">&nbsp;</p>;
  const size = info.grid.max.map((high, d) => significant(high - info.grid.min[d]!, 4)).join(" × ");
  const shown = info.materials.slice(1, 7);
  return (
    <p class="card-facts">
      <span>
        {size} {unit_name(info.units)}
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
  const info = use_answer<GridInfo>(`api/v1/grids/${encodeURIComponent(grid.id)}?v=${grid.hash}`).value;
  const cells = product(grid.cells);
  const id = encodeURIComponent(grid.id);
  const addresses = [{ title: "JSON", path: `/api/v1/grids/${id}` }, ...grid.protocols];
  return (
    <li class="card">
      <a class="card-main" href={`#g=${id}`}>
        <Previews grid={grid} info={info} />
        <h2>{grid.name}</h2>
        <p class="card-facts">
          <span>{sizes(grid.cells)}</span>
          <span>
            <b>{about(cells)}</b> {noun(cells, "cell")}
          </span>
          <span>{bytes_text(grid.bytes)}</span>
        </p>
        <Materials info={info} />
      </a>
      <details>
        <summary>Addresses for other programs</summary>
        <table class="addresses">
          <tbody>
            {addresses.map(({ title, path }) => (
              <tr key={title}>
                <th scope="row">{title}</th>
                <td>
                  <code>{server_root() + path}</code>
                </td>
                <td>
                  <CopyButton text={server_root() + path} what={`the address for ${title}`} />
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      </details>
    </li>
  );
}

function UnreadableCard({ file }: { file: UnreadableFile }) {
  return (
    <li class="card unreadable">
      <h2>
        <Icon name="warning" /> {file.id}
      </h2>
      <p>This file can't be read: {file.error}</p>
    </li>
  );
}

function headline(readable: number, broken: number): string {
  const parts = [readable === 1 ? "One grid" : `${grouped(readable)} grids`, `${plural(broken, "file")} that can't be read`];
  return parts.filter((_, n) => [readable, broken][n]! > 0).join(", ");
}

export function StartPage({ waiting, trouble }: { waiting: string | null; trouble: string | null }) {
  const list = grids.value;
  const broken = unreadable.value;
  if (waiting || (list === null && !trouble))
    return <main class="start" aria-busy="true" aria-label={waiting ? `Opening ${waiting}` : "Looking for grids"} />;
  return (
    <main class="start">
      {trouble && (
        <p class="problem start-trouble" role="alert">
          {trouble}
        </p>
      )}
      {list?.length === 0 && broken.length === 0 && (
        <div class="empty">
          <h1>No grid here yet</h1>
          <p>
            The server is running, but it has no grid to serve. Make one and put it into the folder that is served. It will appear here by itself.
          </p>
          <pre>teracell mesh part.stl --cells 2000 -o part.tcell</pre>
        </div>
      )}
      {list && list.length + broken.length > 0 && (
        <>
          <h1>{headline(list.length, broken.length)}</h1>
          <ul class="cards">
            {list.map((grid) => (
              <Card key={grid.id} grid={grid} />
            ))}
            {broken.map((file) => (
              <UnreadableCard key={file.id} file={file} />
            ))}
          </ul>
        </>
      )}
    </main>
  );
}
