// What `teracell check` has found: a verdict, then kind by kind what it is, where, and a picture of it. And how thick walls are.
import { useMemo, useState } from "preact/hooks";
import { type Finding, type Findings, type Group, type Wall, bodies_of, groups_of, overlaps_reported } from "../base/findings";
import { grouped, plural } from "../base/format";
import { some_names } from "../base/names";
import { quoted } from "../base/shell";
import { use_picture } from "../server/picture";
import { ALL, type Focus } from "../state/findings";
import { go_to_finding } from "../visits/go_there";
import type { Viewer } from "../state/viewer";
import { CodeLine } from "../widgets/copy";
import { Select } from "../widgets/select";
import { KINDS, LEVEL_CARE } from "./finding_words";
import { FirstOf } from "./first_of";
import { GoThere, point_text } from "./places";
import { use_unfolded } from "./kept";

const MANY = 20; // findings listed at once
const [WIDTH, HEIGHT] = [288, 180]; // CSS pixels of a picture
const AROUND = 24; // cells that are seen around a finding
const MOST_SEEN = 160; // and at most across: a wall may go round the whole grid

// The length that a view of a finding should show.
function extent_of(viewer: Viewer, { at, box }: { at: Finding["at"]; box: Finding["box"] }): number {
  const cell = Math.max(...viewer.axes.map((axis, d) => axis.width(axis.cell_at(at![d]!))));
  const sides = box ? viewer.axes.map((axis, d) => axis.plane(box[d + 3]!) - axis.plane(box[d]!)) : [0];
  return Math.min(Math.max(...sides) + AROUND * cell, MOST_SEEN * cell);
}

// Cut open in front of the place, and seen from the direction of the first picture of a grid.
export function picture_address(viewer: Viewer, finding: Finding): string {
  const at = finding.at!;
  const from = at.map((x, d) => x + [0.65, -0.91, 0.585][d]! * 2 * extent_of(viewer, finding));
  const size = `${2 * WIDTH},${2 * HEIGHT}`;
  return viewer.address.view("png", `size=${size}&fov=26&from=${from.join(",")}&at=${at.join(",")}&open=${at.join(",")}&background=%2300000000`);
}

function Picture({ viewer, finding }: { viewer: Viewer; finding: Finding }) {
  const { source, error } = use_picture(picture_address(viewer, finding));
  if (error) return <p class="note">There is no picture.</p>;
  return <div class="finding-picture">{source && <img src={source} width={WIDTH} height={HEIGHT} alt={`The place, cut open: ${finding.text}`} />}</div>;
}

function FindingLine({ viewer, finding, on_visit }: { viewer: Viewer; finding: Finding; on_visit(finding: Finding): void }) {
  const [opened, set_opened] = useState(false);
  const { at, text } = finding;
  return (
    <li class="finding">
      <div class="finding-line">
        <span>
          <span class={`dot ${LEVEL_CARE[finding.level]}`} title={finding.level} aria-label={finding.level} role="img" /> {text}
          {at && <span class="faint"> At {point_text(viewer, at)}.</span>}
        </span>
        {(at || finding.bodies.length > 0) && (
          <GoThere
            what={text}
            go={() => {
              on_visit(finding);
              go_to_finding(viewer, finding);
            }}
          />
        )}
      </div>
      {at && (
        <details onToggle={(e) => set_opened(e.currentTarget.open)}>
          <summary>Picture</summary>
          {opened && <Picture viewer={viewer} finding={finding} />}
        </details>
      )}
    </li>
  );
}

interface GroupProps {
  viewer: Viewer;
  group: Group;
  on_open(opened: boolean): void;
  on_visit(finding: Finding): void;
}

function GroupOf({ viewer, group, on_open, on_visit }: GroupProps) {
  const [opened, unfold] = use_unfolded(viewer, `group ${group.kind}`, group.level === "error");
  const toggle = (now: boolean) => {
    if (now !== opened) on_open(now);
    unfold(now);
  };
  const { name, means } = KINDS[group.kind];
  const hidden = group.total - group.findings.length;
  return (
    <li class="body">
      <details open={opened} onToggle={(e) => toggle(e.currentTarget.open)}>
        <summary>
          <span class={`dot ${LEVEL_CARE[group.level]}`} aria-hidden="true" />
          <span class="body-name">{name}</span>
          <span class="body-cells">{grouped(group.total)}</span>
        </summary>
        {opened && (
          <div class="body-details">
            <p class="note">{means}</p>
            {group.kind === "overlap" && !viewer.labels.some(({ overlap }) => overlap) && (
              <p class="note">
                Meshed with <code>"label_by": "overlap"</code> in the scene, the cells that lie in several bodies are shown by themselves.
              </p>
            )}
            <FirstOf class="places findings" list={group.findings} step={MANY}>
              {(finding, n) => <FindingLine key={n} viewer={viewer} finding={finding} on_visit={on_visit} />}
            </FirstOf>
            {hidden > 0 && <p class="note">{plural(hidden, "more finding")} of this kind {hidden === 1 ? "is" : "are"} counted but not listed.</p>}
          </div>
        )}
      </details>
    </li>
  );
}

// REQUIRES: somewhere it is thin.
function WallLine({ viewer, wall }: { viewer: Viewer; wall: Wall }) {
  const thin = wall.histogram.slice(0, 7);
  const most = Math.max(...thin, 1);
  const words = thin.flatMap((n, i) => (n > 0 ? [`${plural(n, "cell")} in walls of ${plural(i + 1, "cell")}`] : [])).join(", ");
  return (
    <li class="wall">
      <div class="finding-line">
        <span>
          <b>{wall.body}</b>{" "}
          <span class="faint">thinnest: {plural(wall.thinnest_cells!, "cell")}</span>
        </span>
        {wall.at && <GoThere what={`the thinnest wall of ${wall.body}`} go={() => go_to_finding(viewer, { at: wall.at, box: null, bodies: [wall.body] })} />}
      </div>
      <div class="histogram" role="img" aria-label={words}>
        {thin.map((n, i) => (
          <span key={i} title={`${plural(n, "cell")} in walls of ${plural(i + 1, "cell")}`}>
            <span class={`bar ${i < 1 ? "bad" : i < 2 ? "look" : ""}`} style={{ height: `${n === 0 ? 0 : Math.max(4, (100 * n) / most)}%` }} />
            {i + 1}
          </span>
        ))}
      </div>
    </li>
  );
}

// The thin ones have histograms; the others are named together.
function Walls({ viewer, walls }: { viewer: Viewer; walls: readonly Wall[] }) {
  const thin = walls.filter(({ thinnest_cells }) => thinnest_cells !== null);
  const thick = walls.filter(({ thinnest_cells }) => thinnest_cells === null).map(({ body }) => body);
  return (
    <section>
      <h3>Walls</h3>
      {thin.length > 0 && <p class="note">How many cells lie in walls of 1 to 7 cells.</p>}
      <FirstOf class="walls" list={thin} step={MANY}>{(wall) => <WallLine key={wall.body} viewer={viewer} wall={wall} />}</FirstOf>
      {thick.length > 0 && <p class="note">At least 8 cells thick everywhere: {thin.length > 0 || thick.length === 1 ? some_names(thick) : `all ${grouped(thick.length)}`}.</p>}
    </section>
  );
}

// `on_focus` is told what of the findings is looked at.
export function FindingsList({ viewer, findings, on_focus }: { viewer: Viewer; findings: Findings; on_focus(focus: Focus): void }) {
  const [focus, set_focus] = useState(ALL);
  const { body } = focus;
  const look_at = (next: Focus) => {
    set_focus(next);
    on_focus(next);
  };
  const bodies = useMemo(() => bodies_of(findings), [findings]);
  const choices = [{ value: "", label: "all bodies" }, ...bodies.map((name) => ({ value: name, label: name }))];
  const groups = useMemo(() => groups_of(findings, body), [findings, body]);
  const walls = findings.walls.filter((wall) => !body || wall.body === body);
  return (
    <>
      <section>
        <h3>Findings</h3>
        {bodies.length > 1 && (
          <label class="filter">
            of <Select label="The body whose findings are listed" value={body} list={choices} set={(name) => look_at({ ...ALL, body: name })} />
          </label>
        )}
        {groups.length === 0 && <p class="note">Nothing was found{body ? ` about ${body}` : ""}.</p>}
        <ul class="bodies">
          {groups.map((group) => (
            <GroupOf
              key={group.kind}
              viewer={viewer}
              group={group}
              on_open={(opened) => (opened || focus.kind === group.kind) && look_at({ body, kind: opened ? group.kind : null, finding: null })}
              on_visit={(finding) => look_at({ body, kind: group.kind, finding })}
            />
          ))}
        </ul>
      </section>
      {walls.length > 0 && <Walls viewer={viewer} walls={walls} />}
      {findings.not_looked_at.length > 0 && (
        <section>
          <h3>Not looked at</h3>
          <ul class="warnings">
            {findings.not_looked_at.map((text) => (
              <li key={text}>{text}</li>
            ))}
          </ul>
        </section>
      )}
    </>
  );
}

// Where nobody has looked, what would.
export function NotChecked({ viewer, error }: { viewer: Viewer; error: string | null }) {
  const overlaps = useMemo(() => overlaps_reported(viewer.info.report), [viewer]);
  if (error) return <p class="problem">What was found could not be loaded: {error}.</p>;
  return (
    <>
      {overlaps && (
        <section>
          <h3>Findings</h3>
          <ul class="bodies">
            <GroupOf viewer={viewer} group={overlaps} on_open={() => {}} on_visit={() => {}} />
          </ul>
        </section>
      )}
      <section>
        <h3>Not looked at</h3>
        <p class="note">Thin walls, islands and enclosed background: nobody has looked for them yet. This does, beside the file:</p>
        <CodeLine class="hash" text={`teracell check ${quoted(`${viewer.info.id}.tcell`)}`} what="the command" />
      </section>
    </>
  );
}
