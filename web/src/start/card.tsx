// A grid on the start page: pictures of it, what it is made of, and what is wrong with it.
import { type Signal, useSignal } from "@preact/signals";
import { useRef } from "preact/hooks";
import { Axis } from "../base/axis";
import { needs_other_ground } from "../base/contrast";
import { about, bytes_text, grouped, noun, product, significant, sizes, unit_name } from "../base/format";
import { GridAddress, type GridInfo, type GridSummary } from "../base/grid";
import { initial_looks } from "../base/materials";
import { verdict } from "../panels/finding_words";
import { type Care, DAMAGED, care_of } from "../panels/report_words";
import { checked_findings, server_root } from "../server/api";
import { use_answer } from "../server/answer";
import { use_picture } from "../server/picture";
import { is_read_here } from "../server/transport";
import { theme } from "../state/theme";
import { CopyButton } from "../widgets/copy";
import { Icon } from "../widgets/icons";
import { use_seen } from "./in_sight";
import { NoPicture } from "./no_picture";
import { Preview } from "./preview";

const [WIDTH, HEIGHT] = [300, 216]; // CSS pixels of the picture in three dimensions

interface PictureProps {
  readonly grid: GridSummary;
  readonly wanted: boolean;
  readonly damage: Signal<string | null>; // what a picture could not show
}

function Picture({ grid, wanted, damage }: PictureProps) {
  const size = `${2 * WIDTH},${2 * HEIGHT}`;
  const address = new GridAddress(grid.id, grid.hash).view("png", `size=${size}&fov=26&background=%2300000000`);
  const { source, error } = use_picture(wanted ? address : null);
  return (
    <span class="preview preview-3d">
      {source && <img src={source} width={WIDTH} height={HEIGHT} alt={`${grid.name} in three dimensions`} />}
      {error !== null && <NoPicture error={error} damage={damage} />}
    </span>
  );
}

function Pictures({ grid, info, wanted, damage }: PictureProps & { info: GridInfo | null }) {
  const axes = info?.grid.axes.map((axis, d) => new Axis(axis, info.grid.sample[d]!));
  const opaque = initial_looks(info?.materials.slice(1) ?? []).filter((look) => look.opacity > 0.5);
  const other_ground = needs_other_ground(theme.value, opaque.map((look) => look.color));
  return (
    <span class={`previews ${other_ground ? "other-ground" : ""}`}>
      <Picture grid={grid} wanted={wanted} damage={damage} />
      {([2, 1, 0] as const).map((axis) =>
        axes ? <Preview key={axis} grid={grid} axes={axes} axis={axis} damage={damage} /> : <span key={axis} class="preview" />,
      )}
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

function CareLine({ grid, info, wanted }: { grid: GridSummary; info: GridInfo | null; wanted: boolean }) {
  const { value: findings } = use_answer(wanted && grid.checked ? grid.id : null, checked_findings); // the report panel says what is wrong
  if (!info || (grid.checked && !findings)) return <p class="card-care">&nbsp;</p>;
  const care: Care = findings ? verdict(findings) : care_of(info);
  if (!findings && care.level === "fine")
    return (
      <p class="card-care faint">
        {is_read_here(grid.id)
          ? "Not checked, or what the command “teracell check” found is not with this page."
          : "Not checked yet: the command “teracell check” looks for thin walls, islands and more."}
      </p>
    );
  return (
    <p class={`card-care ${care.level}`}>
      <Icon name={care.level === "fine" ? "done" : "warning"} />
      <span>{findings ? care.text : `${care.text} Not checked further yet.`}</span>
    </p>
  );
}

function DamageLine({ reason }: { reason: string }) {
  return (
    <p class="card-care bad" title={reason}>
      <Icon name="warning" />
      <span>{DAMAGED.text}</span>
    </p>
  );
}

function Addresses({ grid }: { grid: GridSummary }) {
  const addresses = [{ title: "JSON", path: `/api/v1/grids/${encodeURIComponent(grid.id)}` }, ...grid.protocols];
  return (
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
  );
}

export function Card({ grid }: { grid: GridSummary }) {
  const element = useRef<HTMLLIElement>(null);
  const seen = use_seen(element);
  const id = encodeURIComponent(grid.id);
  const info = use_answer<GridInfo>(seen ? `api/v1/grids/${id}?v=${grid.hash}` : null).value;
  const cells = product(grid.cells);
  const damage = useSignal<string | null>(null);
  const reason = grid.damage ?? damage.value;
  return (
    <li class={reason ? "card damaged" : "card"} ref={element}>
      <a class="card-main" href={`#g=${id}`}>
        <Pictures grid={grid} info={info} wanted={seen} damage={damage} />
        <h2>{grid.name}</h2>
        <p class="card-facts">
          <span>{sizes(grid.cells)}</span>
          <span>
            <b>{about(cells)}</b> {noun(cells, "cell")}
          </span>
          <span>{bytes_text(grid.bytes)}</span>
          {grid.modified !== null && <span>{new Date(1000 * grid.modified).toLocaleDateString("en-GB", { dateStyle: "medium" })}</span>}
        </p>
        <Materials info={info} />
        {reason ? <DamageLine reason={reason} /> : <CareLine grid={grid} info={info} wanted={seen} />}
      </a>
      {!is_read_here(grid.id) && <Addresses grid={grid} />}
    </li>
  );
}
