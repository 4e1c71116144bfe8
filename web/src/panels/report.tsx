// What meshing found: whether to care first, then why, body by body, with places to go to.
import { useEffect } from "preact/hooks";
import type { BodyReport } from "../api";
import { CopyButton } from "../copy";
import { about, bytes_text, grouped, plural, product, significant } from "../format";
import { Icon } from "../icons";
import type { Marker, Viewer } from "../viewer";
import { BodyDetails } from "./report_body";
import { body_cells, care_of, compression, hole_text } from "./report_words";

const MOST_MARKERS = 500;
const MANY_BODIES = 8; // from here on only those with something to say are unfolded

export function places_found(viewer: Viewer): Marker[] {
  const { bodies } = viewer.info.report;
  const holes = bodies.flatMap((b) => b.holes.map((h) => ({ at: h.at, size: h.diameter, text: `hole in ${b.name}: ${hole_text(h, viewer.info.units)}` })));
  holes.sort((a, b) => b.size - a.size);
  const flips = bodies.flatMap((b) => b.flips.map((f) => ({ at: f.at, text: `${b.name}: facets face the other way along ${plural(f.edges, "edge")}` })));
  return [...holes.map(({ at, text }) => ({ at, text })), ...flips].slice(0, MOST_MARKERS);
}

const has_something_to_say = (b: BodyReport) => b.holes.length > 0 || b.flips.length > 0 || b.cells === 0;

function Body({ viewer, body, open }: { viewer: Viewer; body: BodyReport; open: boolean }) {
  const problem = has_something_to_say(body);
  return (
    <details class="body" open={open}>
      <summary>
        <span class="body-name" title={body.name}>
          {body.name}
        </span>
        {problem && <span class={`tag ${body.cells === 0 ? "bad" : "look"}`}>{body.cells === 0 ? "no cells" : body.holes.length ? plural(body.holes.length, "hole") : "flipped"}</span>}
        <span class="body-cells">{body_cells(body)} cells</span>
      </summary>
      <BodyDetails viewer={viewer} body={body} />
    </details>
  );
}

export function ReportPanel({ viewer }: { viewer: Viewer }) {
  const { info } = viewer;
  const { report } = info;
  const care = care_of(info);
  const { dense, times } = compression(info);
  const places = places_found(viewer);
  const marked = viewer.markers.value.length > 0;
  useEffect(() => {
    if (places.length && !viewer.markers.peek().length) viewer.markers.value = places;
  }, [viewer]);
  const bodies = [...report.bodies].sort((a, b) => Number(has_something_to_say(b)) - Number(has_something_to_say(a)));
  return (
    <>
      <p class={`care ${care.level}`}>
        <Icon name={care.level === "fine" ? "done" : "warning"} />
        <span>{care.text}</span>
      </p>
      {places.length > 0 && (
        <label class="check">
          <input type="checkbox" checked={marked} onChange={() => (viewer.markers.value = marked ? [] : places)} />
          Mark {plural(places.length, "place")} in the views
        </label>
      )}
      {report.warnings.length > 0 && (
        <section>
          <h3>Warnings</h3>
          <ul class="warnings">
            {report.warnings.map((text) => (
              <li key={text}>{text.charAt(0).toUpperCase() + text.slice(1)}</li>
            ))}
          </ul>
        </section>
      )}
      <section>
        <h3>Bodies</h3>
        {bodies.length === 0 && <p class="note">There are none: the whole grid is background.</p>}
        {bodies.map((body, n) => (
          <Body key={body.name} viewer={viewer} body={body} open={bodies.length < MANY_BODIES ? has_something_to_say(body) || bodies.length === 1 : has_something_to_say(body) && n < 3} />
        ))}
      </section>
      <section>
        <h3>File</h3>
        <dl class="numbers">
          <div>
            <dt>size</dt>
            <dd title={`${grouped(info.file.bytes)} bytes`}>{bytes_text(info.file.bytes)}</dd>
          </div>
          <div>
            <dt>one byte a cell</dt>
            <dd title={`${grouped(product(info.grid.cells))} bytes`}>
              {bytes_text(dense)}: {times >= 1000 ? about(Math.round(times)) : significant(times, 3)} times as much
            </dd>
          </div>
          <div>
            <dt>crossings</dt>
            <dd>{grouped(info.crossings)}</dd>
          </div>
          <div>
            <dt>bits a crossing</dt>
            <dd>{significant(info.bits_per_crossing, 3)}</dd>
          </div>
          <div>
            <dt>rays</dt>
            <dd>
              along {info.ray_axis}
              {report.ray_axis ? `: ${report.ray_axis.why}` : ""}
            </dd>
          </div>
          <div>
            <dt>levels</dt>
            <dd>
              {info.levels.length}, of cells up to {grouped(2 ** (info.levels.length - 1))} times as wide
            </dd>
          </div>
          <div>
            <dt>content</dt>
            <dd class="hash">
              <code title={info.file.hash}>{info.file.hash}</code>
              <CopyButton text={info.file.hash} what="the content's hash" />
            </dd>
          </div>
        </dl>
      </section>
      <section>
        <h3>Inputs</h3>
        <ul class="inputs">
          {report.inputs.map((input, n) => (
            <li key={n}>
              <span class="input-path" title={input.path}>
                {input.path}
              </span>
              <span class="faint">
                {input.format}, {bytes_text(input.bytes)}
              </span>
              <span class="hash">
                <code title={input.hash}>{input.hash}</code>
                <CopyButton text={input.hash} what={`the hash of ${input.path}`} />
              </span>
            </li>
          ))}
        </ul>
      </section>
    </>
  );
}
