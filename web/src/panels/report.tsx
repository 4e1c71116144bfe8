// What meshing found: first whether it matters, then why, body by body, with places to look at.
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { bytes_text, grouped, plural, product, prose, significant, upper_first } from "../base/format";
import type { BodyReport } from "../base/grid";
import { use_answer } from "../server/answer";
import { damaged_grids, grid_findings } from "../server/api";
import { ALL, type Focus, markers_of } from "../state/findings";
import { on_phone } from "../state/phone";
import { places_found } from "../state/places";
import type { Viewer } from "../state/viewer";
import { CodeLine } from "../widgets/copy";
import { Fact } from "../widgets/fact";
import { Icon } from "../widgets/icons";
import { KINDS, not_checked, verdict } from "./finding_words";
import { FindingsList, NotChecked } from "./findings";
import { FirstOf } from "./first_of";
import { BodyDetails } from "./report_body";
import { type Care, DAMAGED, body_cells, care_of, levels_text, size_text } from "./report_words";
import { use_unfolded } from "./kept";

const MANY = 100; // items of a list that are shown at once
const MANY_BODIES = 8; // with this many or more, only those with something to say are unfolded

const has_something_to_say = (b: BodyReport) => b.holes.length > 0 || b.flips.length > 0 || b.cells === 0;

function Body({ viewer, body, open }: { viewer: Viewer; body: BodyReport; open: boolean }) {
  const [opened, unfold] = use_unfolded(viewer, `body ${body.name}`, open); // the details of a body that is folded are not made
  const problem = has_something_to_say(body);
  return (
    <li class="body">
      <details open={opened} onToggle={(e) => unfold(e.currentTarget.open)}>
        <summary>
          <span class="body-name" title={body.name}>
            {body.name}
          </span>
          {problem && (
            <span class={`tag ${body.cells === 0 ? "bad" : "look"}`}>
              {body.cells === 0 ? "no cells" : body.holes.length ? plural(body.holes.length, "hole") : "opposite facets"}
            </span>
          )}
          <span class="body-cells">{body_cells(body)}</span>
        </summary>
        {opened && <BodyDetails viewer={viewer} body={body} />}
      </details>
    </li>
  );
}

function CareLine({ care }: { care: Care }) {
  return (
    <p class={`care ${care.level}`}>
      <Icon name={care.level === "fine" ? "done" : "warning"} />
      <span>{care.text}</span>
    </p>
  );
}

// What of the findings is marked, where it isn't all.
const marks_of = ({ body, kind }: Focus): string => {
  const parts = [kind && KINDS[kind].name.toLowerCase(), body && `of ${body}`].filter(Boolean);
  return parts.length ? `: ${parts.join(" ")}` : "";
};

export function ReportPanel({ viewer }: { viewer: Viewer }) {
  const { info } = viewer;
  const { report } = info;
  const { value: findings, path, error } = use_answer(info.id, grid_findings);
  const known = path !== null || error !== null;
  const care = findings ? verdict(findings) : known ? not_checked(care_of(info)) : care_of(info);
  const [focus, set_focus] = useState(ALL);
  const places = useMemo(() => (findings ? markers_of(findings, focus) : places_found(info)), [info, findings, focus]);
  const marked = viewer.markers.value.length > 0;
  const begun = useRef(false); // later, places that people have taken out of the views stay out
  useEffect(() => {
    if (!known) return;
    if (!begun.current || viewer.markers.peek().length) viewer.markers.value = places;
    begun.current = true;
  }, [viewer, known, places]);
  // The marks go with the panel. On phones, where it lies over them, they stay until another one is opened.
  useEffect(
    () => () => {
      const panel = viewer.panel.peek();
      if (panel !== "report" && (panel || !on_phone.peek())) viewer.markers.value = [];
    },
    [viewer],
  );
  const bodies = [...report.bodies].sort((a, b) => Number(has_something_to_say(b)) - Number(has_something_to_say(a)));
  const few = bodies.length < MANY_BODIES;
  return (
    <>
      {damaged_grids.value.includes(info.id) && <CareLine care={DAMAGED} />}
      <CareLine care={care} />
      {places.length > 0 && (
        <label class="check">
          <input type="checkbox" checked={marked} onChange={() => (viewer.markers.value = marked ? [] : places)} />
          Mark {plural(places.length, "place")} in the views{marks_of(focus)}
        </label>
      )}
      {findings && <FindingsList viewer={viewer} findings={findings} on_focus={set_focus} />}
      {known && !findings && <NotChecked viewer={viewer} error={error} />}
      {report.warnings.length > 0 && (
        <section>
          <h3>Warnings</h3>
          <FirstOf class="warnings" list={report.warnings} step={MANY}>
            {(text, n) => <li key={n}>{prose(upper_first(text))}</li>}
          </FirstOf>
        </section>
      )}
      <section>
        <h3>Bodies</h3>
        {bodies.length === 0 && <p class="note">There is no body: the whole grid is background.</p>}
        <FirstOf class="bodies" list={bodies} step={MANY}>
          {(body, n) => (
            <Body key={body.name} viewer={viewer} body={body} open={bodies.length === 1 || (has_something_to_say(body) && (few || n < 3))} />
          )}
        </FirstOf>
      </section>
      <section>
        <h3>File</h3>
        <dl class="numbers">
          <Fact name="size" title={`${grouped(info.file.bytes)} bytes`}>
            {bytes_text(info.file.bytes)}
          </Fact>
          <Fact name="one byte per cell" title={`${grouped(product(info.grid.cells))} bytes`}>
            {size_text(info)}
          </Fact>
          <Fact name="crossings">{grouped(info.crossings)}</Fact>
          <Fact name="bits per crossing">{significant(info.bits_per_crossing, 3)}</Fact>
          <Fact name="rays">
            along {info.ray_axis}
            {report.ray_axis ? `: ${report.ray_axis.why}` : ""}
          </Fact>
          <Fact name="levels">{levels_text(info.levels.length)}</Fact>
          <Fact name="content hash">
            <CodeLine class="hash" text={info.file.hash} what="the content hash" />
          </Fact>
        </dl>
      </section>
      <section>
        <h3>Inputs</h3>
        <FirstOf class="inputs" list={report.inputs} step={MANY}>
          {(input, n) => (
            <li key={n}>
              <span class="input-path" title={input.path}>
                {input.path}
              </span>
              <span class="faint">
                {input.format}, {bytes_text(input.bytes)}
              </span>
              <CodeLine class="hash" text={input.hash} what={`the hash of ${input.path}`} />
            </li>
          )}
        </FirstOf>
      </section>
    </>
  );
}
