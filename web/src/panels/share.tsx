// Ways to share: a link to what is shown, a picture of it, one file with the grid in it, and the addresses of the grid for other programs.
import { useState } from "preact/hooks";
import { save_blob } from "../base/download";
import { bytes_text } from "../base/format";
import type { GridInfo } from "../base/grid";
import { quoted } from "../base/shell";
import { whole_page } from "../module/beside";
import { MOST_HELD, page_with } from "../module/held";
import { get, has_token, list_grids, server_root } from "../server/api";
import { is_read_here, must_be_given } from "../server/transport";
import { address_of } from "../state/permalink";
import type { Viewer } from "../state/viewer";
import { CodeLine, CopyButton } from "../widgets/copy";
import { save_picture } from "../views/picture";
import { Icon } from "../widgets/icons";
import { use_task } from "../widgets/task";
import { type Door, NEUROGLANCER, doors, is_loopback, neuroglancer_link, neuroglancer_state } from "./share_links";

const PAGE = 1_350_000; // bytes of a page without a grid, about
const about_bytes = (grid: number) => (4 / 3) * grid + PAGE; // base64

const link = (viewer: Viewer) => `${location.href.split("#")[0]}${address_of(viewer)}`;

function DoorCard({ door }: { door: Door }) {
  return (
    <div class="door">
      <h4>{door.name}</h4>
      {door.note && <p class="note">{door.note}</p>}
      {door.packages.length > 0 && (
        <p class="note">
          {door.language === "python" || door.language === "shell" ? "Debian" : "npm"}: <code>{door.packages.join(" ")}</code>
        </p>
      )}
      <CodeLine class="code-line" text={door.address} what={`the address for ${door.name}`} />
      {door.lines && (
        <div class="code-line">
          <pre>{door.lines}</pre>
          <CopyButton text={door.lines} what={`the lines for ${door.name}`} />
        </div>
      )}
    </div>
  );
}

function SavePicture({ viewer }: { viewer: Viewer }) {
  const { busy, start } = use_task(() => save_picture(viewer), "The picture could not be made");
  return (
    <button class="button" onClick={start} disabled={busy}>
      <Icon name="save" /> {busy ? "Drawing …" : "Save as PNG"}
    </button>
  );
}

function neuroglancer_note(): string {
  if (has_token()) return "Neuroglancer can't send this server's token, so the server will refuse it.";
  const fetches = "Neuroglancer runs in your browser and fetches the cells from this server";
  if (is_loopback(location.hostname))
    return `${fetches}, which must have been started with --allow-origin ${NEUROGLANCER}. The browser may ask for your permission.`;
  if (location.protocol === "https:")
    return `${fetches}, so your browser must be able to reach it. Behind a proxy it may need --allow-origin ${NEUROGLANCER}.`;
  const under_https = "Neuroglancer is a page under https, and browsers don't let such a page fetch from a server under plain http.";
  return `${under_https} Put a server with https in front of this one.`;
}

const too_large = ({ file }: GridInfo) => file.bytes > MOST_HELD;

// REQUIRES: there is a whole page.
function SavePageButton({ info }: { info: GridInfo }) {
  const save = async () => {
    const grid = await (await get(`api/v1/grids/${encodeURIComponent(info.id)}/file.tcell`)).blob();
    const { grids } = await list_grids();
    const { hash } = info.file;
    const checked = grids.find((listed) => listed.id === info.id && listed.hash === hash)?.checked
      ? { hash, findings: await (await get(`api/v1/grids/${encodeURIComponent(info.id)}/check`)).text() }
      : null;
    save_blob(await page_with(await whole_page!(), `${info.id}.tcell`, grid, checked), `${info.id}.html`);
  };
  const { busy, start } = use_task(save, "The page can't be saved");
  return (
    <>
      <button class="button" onClick={start} disabled={busy || too_large(info)}>
        <Icon name="save" /> {busy ? "Saving …" : "Save as one file"}
      </button>
      {!too_large(info) && <span class="note">about {bytes_text(about_bytes(info.file.bytes))}</span>}
    </>
  );
}

// The grid and this page as one HTML file, for somebody who has neither.
function SavePage({ info }: { info: GridInfo }) {
  if (whole_page === null) return null;
  return (
    <section>
      <h3>One file for anybody</h3>
      <div class="toolbar">
        <SavePageButton info={info} />
      </div>
      <p class="note">
        {too_large(info)
          ? `The grid has ${bytes_text(info.file.bytes)}, and a browser would hold all of it in memory: at most ${bytes_text(MOST_HELD)} fit into one file. “teracell page” writes a folder for a host of files instead.`
          : "An HTML file with this page and the whole grid in it. It opens from a disk or a mail, without a network, in Chromium, Firefox and others."}
      </p>
    </section>
  );
}

// What a link that was copied can't do, and what can be sent in its place.
function OnlyHere({ info }: { info: GridInfo }) {
  const other = whole_page !== null && !too_large(info);
  const what = location.protocol === "file:" ? "it names a file of its disk. Send that file, too" : `on another one, ${location.host} means that one`;
  return (
    <div class="only-here" role="status">
      <p>
        <strong>The link works on this machine only:</strong> {what}. {other && "Anybody can open the grid as one file:"}
        {!other && location.protocol !== "file:" && "A server that was started with --host is reached from others."}
      </p>
      {other && (
        <div class="toolbar">
          <SavePageButton info={info} />
        </div>
      )}
    </div>
  );
}

function Doors({ viewer }: { viewer: Viewer }) {
  const { info } = viewer;
  const cell = viewer.cell.value;
  const state = neuroglancer_state(info, server_root(), cell, viewer.looks.value, viewer.zoom.value);
  return (
    <>
      <section>
        <h3>Neuroglancer</h3>
        <a class="button" href={neuroglancer_link(state)} target="_blank" rel="noreferrer">
          <Icon name="away" /> Open in Neuroglancer
        </a>
        <p class="note">{neuroglancer_note()}</p>
      </section>
      <section>
        <h3>Other programs</h3>
        {has_token() && <p class="note">Each program must send the token in a header: “Authorization: Bearer …”</p>}
        {doors(info, server_root(), cell).map((door) => (
          <DoorCard key={door.name} door={door} />
        ))}
      </section>
    </>
  );
}

// Programs can't ask a page for cells. They read the file, or ask a server.
function FileAlone({ info }: { info: GridInfo }) {
  const file = quoted(`${info.id}.tcell`);
  return (
    <section>
      <h3>Other programs</h3>
      <p class="note">This page reads the grid by itself. Where the file is, a server gives it to Neuroglancer, Zarr, ParaView and others:</p>
      <CodeLine class="code-line" text={`teracell serve ${file}`} what="the command that serves the grid" />
    </section>
  );
}

export function SharePanel({ viewer }: { viewer: Viewer }) {
  const { info } = viewer;
  const here = is_read_here(info.id);
  const [copied, set_copied] = useState(false);
  return (
    <>
      <section>
        <h3>What you see</h3>
        <div class="toolbar">
          <CopyButton label="Copy link" what="a link to what you see" text={() => link(viewer)} done={() => set_copied(true)} />
          <SavePicture viewer={viewer} />
          <button class="button" onClick={() => (viewer.figure.value = true)}>
            <Icon name="picture" /> Figure …
          </button>
        </div>
        {copied && (location.protocol === "file:" || is_loopback(location.hostname)) && <OnlyHere info={info} />}
        <p class="note">
          The link holds everything that you see, except the choice of light or dark. {must_be_given(info.id) && "The file was given to this page by hand, so the link shows it only where it was given to the page before. "}The
          picture has a scale bar and a legend.
        </p>
      </section>
      <SavePage info={info} />
      {here ? <FileAlone info={info} /> : <Doors viewer={viewer} />}
    </>
  );
}
