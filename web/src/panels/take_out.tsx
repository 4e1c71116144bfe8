// The cells of the box as a file, or as lines that fetch them.
import { save_blob } from "../base/download";
import { bytes_text, grouped, product } from "../base/format";
import { AXES, type Material } from "../base/grid";
import { quoted } from "../base/shell";
import { get, has_token, list_grids, server_root } from "../server/api";
import { answerer, is_read_here } from "../server/transport";
import type { Box, Viewer } from "../state/viewer";
import { CodeLine, CopyButton } from "../widgets/copy";
import { Icon } from "../widgets/icons";
import { use_task } from "../widgets/task";

const MOST = 2n ** 32n; // cells that the server sends
const MOST_HELD = 512n << 20n; // bytes that the page holds

const FEW = 12; // materials that fit a comment

// Which number is which material. Where there are many, `address` has all of them.
export const numbers_comment = (materials: readonly Material[], address: string): string => {
  const named = materials.slice(0, FEW).map(({ id, name }) => `${id} ${name.replace(/\s+/g, " ")}`);
  return `# ${named.join(", ")}${materials.length > FEW ? ` and ${grouped(materials.length - FEW)} more: ${address}` : ""}`;
};

// Lines of Python that fetch a box: NumPy and the standard library are enough.
export const box_snippet = (address: string, numbers: string): string =>
  [
    "import io, urllib.request",
    "import numpy",
    `answer = urllib.request.urlopen("${address}")`,
    "cells = numpy.load(io.BytesIO(answer.read()))  # [z, y, x], numbers of materials",
    numbers,
  ].join("\n");

// Where an answer has begun and then can't go on, it ends too early, without a reason. The list of grids may have it.
async function cells_at(viewer: Viewer, address: string): Promise<Blob> {
  const answer = await get(address);
  try {
    return await answer.blob();
  } catch {
    const { grids } = await list_grids();
    const damaged = grids.some(({ id, damage }) => id === viewer.info.id && damage);
    throw new Error(damaged ? "the file is damaged, and a part of the box can't be read" : `${answerer()} has ended its answer too early`);
  }
}

// A button, which can say what is wrong. What is too large for the page is a link, where the browser can fetch it by itself.
function SaveAs({ viewer, box, ending, held }: { viewer: Viewer; box: Box; ending: "npy" | "vti" | "vtr"; held: boolean }) {
  const address = viewer.address.box(ending, box);
  const name = `${viewer.info.id}-box.${ending}`;
  const { busy, start } = use_task(async () => save_blob(await cells_at(viewer, address), name), "The box can't be saved");
  const text = (
    <>
      <Icon name="save" /> .{ending}
    </>
  );
  if (!held)
    return (
      <a class="button" href={address} download={name} aria-label={`Save as .${ending}`}>
        {text}
      </a>
    );
  return (
    <button class="button" disabled={busy} onClick={start} aria-label={`Save as .${ending}`}>
      {text}
    </button>
  );
}

export function TakeOut({ viewer, box }: { viewer: Viewer; box: Box }) {
  const cells = product(AXES.map((d) => box[d + 3]! - box[d]));
  const bytes = cells * (viewer.info.materials.length > 256 ? 2n : 1n);
  const here = is_read_here(viewer.info.id);
  const alone = !here && !has_token(); // whether the browser can fetch it by itself
  const held = !alone || bytes <= MOST_HELD;
  const vtk = viewer.axes.some((axis) => axis.graded) ? "vtr" : "vti";
  const numbers = numbers_comment(viewer.info.materials, `${server_root()}/api/v1/grids/${encodeURIComponent(viewer.info.id)}`);
  const lines = box_snippet(`${server_root()}/${viewer.address.box("npy", box)}`, numbers);
  const fits = cells <= MOST && (alone || bytes <= MOST_HELD);
  return (
    <section>
      <h3>Take the cells out</h3>
      {fits ? (
        <>
          <div class="toolbar">
            <SaveAs viewer={viewer} box={box} ending="npy" held={held} />
            <SaveAs viewer={viewer} box={box} ending={vtk} held={held} />
            <span class="note">{bytes_text(Number(bytes))}</span>
          </div>
          <p class="note">.npy for NumPy, .{vtk} for ParaView.</p>
          {!here && (
            <>
              <p class="note">
                With Python, these lines fetch the box; they need <code>python3-numpy</code>
                {alone ? "." : ", and a server that asks for no token."}
              </p>
              <div class="code-line">
                <pre>{lines}</pre>
                <CopyButton text={lines} what="the lines that fetch the box" />
              </div>
            </>
          )}
        </>
      ) : (
        <>
          <p class="note">
            {grouped(cells)} cells are more than {alone ? "the server sends at once" : "the page can hold"}. On the machine that has the file:
          </p>
          <CodeLine
            class="hash"
            text={`teracell export ${quoted(`${viewer.info.id}.tcell`)} -o box.npy --region ${box.join(",")}`}
            what="the command that writes the box"
          />
        </>
      )}
    </section>
  );
}
