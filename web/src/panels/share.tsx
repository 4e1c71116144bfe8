// Ways to share: a link to what is shown, a picture of it, and the addresses of the grid for other programs.
import { has_token, server_root } from "../server/api";
import { address_of } from "../state/permalink";
import type { Viewer } from "../state/viewer";
import { CodeLine, CopyButton } from "../widgets/copy";
import { Icon } from "../widgets/icons";
import { use_save_picture } from "./save_picture";
import { type Door, NEUROGLANCER, doors, neuroglancer_link, neuroglancer_state } from "./share_links";

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
  const { busy, save } = use_save_picture(viewer);
  return (
    <button class="button" onClick={save} disabled={busy}>
      <Icon name="save" /> {busy ? "Drawing …" : "Save as PNG"}
    </button>
  );
}

function neuroglancer_note(): string {
  if (has_token()) return "Neuroglancer can't send this server's token, so the server will refuse it.";
  const fetches = "Neuroglancer runs in your browser and fetches the cells from this server";
  if (["localhost", "127.0.0.1", "[::1]"].includes(location.hostname))
    return `${fetches}, which must have been started with --allow-origin ${NEUROGLANCER}. The browser may ask for your permission.`;
  if (location.protocol === "https:")
    return `${fetches}, so your browser must be able to reach it. Behind a proxy it may need --allow-origin ${NEUROGLANCER}.`;
  const under_https = "Neuroglancer is a page under https, and browsers don't let such a page fetch from a server under plain http.";
  return `${under_https} Put a server with https in front of this one.`;
}

export function SharePanel({ viewer }: { viewer: Viewer }) {
  const { info } = viewer;
  const cell = viewer.cell.value;
  const state = neuroglancer_state(info, server_root(), cell, viewer.looks.value, viewer.zoom.value);
  return (
    <>
      <section>
        <h3>What you see</h3>
        <div class="toolbar">
          <CopyButton label="Copy link" what="a link to what you see" text={() => link(viewer)} />
          <SavePicture viewer={viewer} />
          <button class="button" onClick={() => (viewer.figure.value = true)}>
            <Icon name="picture" /> Figure …
          </button>
        </div>
        <p class="note">The link holds everything that you see, except the choice of light or dark. The picture has a scale bar and a legend.</p>
      </section>
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
