// One body of the report: its facets, how its inside was decided, its holes, and where its facets face opposite ways.
import type { ComponentChildren } from "preact";
import { grouped, plural, significant } from "../base/format";
import { type AxisIndex, type BodyReport, type Hole, for_axes } from "../base/grid";
import { go_to_finding } from "../visits/go_there";
import { labels_named } from "../state/isolation";
import { shared_material } from "../state/named_places";
import { hole_text } from "../state/places";
import type { Box, Viewer } from "../state/viewer";
import { Fact } from "../widgets/fact";
import { FirstOf } from "./first_of";
import { GoThere, point_text } from "./places";
import { seams_text } from "./report_words";

const MANY = 30; // places listed at once

// The cells around a hole.
function box_of(viewer: Viewer, { at, diameter }: Hole): Box {
  const cell = (d: AxisIndex, side: number) => viewer.axes[d].clamp(viewer.axes[d].cell_at(at[d] + (side * diameter) / 2));
  return [...for_axes((d) => cell(d, -1)), ...for_axes((d) => cell(d, 1) + 1)] as Box;
}

// A place, with what is there and the button that goes there.
function PlaceLine({ what, go, children }: { what: string; go: () => void; children: ComponentChildren }) {
  return (
    <li>
      <span>{children}</span>
      <GoThere what={what} go={go} />
    </li>
  );
}

export function BodyDetails({ viewer, body }: { viewer: Viewer; body: BodyReport }) {
  const { units } = viewer;
  const shared = shared_material(viewer, body.name);
  const is_named = labels_named(viewer.info, [body.name]).length > 0;
  const holes = [...body.holes].sort((a, b) => b.diameter - a.diameter);
  return (
    <div class="body-details">
      <dl class="numbers">
        <Fact name="facets">
          {grouped(body.facets)} in {plural(body.shells, "shell")}
        </Fact>
        {body.covered_cells && <Fact name="overlap">{plural(body.covered_cells, "cell")}, owned by stronger bodies</Fact>}
        {body.degenerate > 0 && <Fact name="without area">{grouped(body.degenerate)}; they change no cell of a closed surface</Fact>}
        {body.duplicates > 0 && (
          <Fact name="duplicates">
            {grouped(body.duplicates)}
            {body.opposite ? `, ${grouped(body.opposite)} of them with the opposite orientation` : ""}
          </Fact>
        )}
        <Fact name="surface">{holes.length ? `open: ${plural(holes.length, "hole")}` : body.seams?.number ? "closed by stitches" : "closed"}</Fact>
        {seams_text(body, viewer.units) && <Fact name="seams">{seams_text(body, viewer.units)}</Fact>}
      </dl>
      {body.fill.map((fill) => (
        <p class="note" key={fill.rule}>
          Inside of {plural(fill.shells, "shell")}: <b>{fill.rule}</b>, {fill.why}
        </p>
      ))}
      {body.cells === 0 && (
        <p class="problem">
          It owns no cell: it encloses nothing, lies outside the grid or between the sample points, or stronger bodies own all of its cells.
        </p>
      )}
      {body.cells > 0 && is_named && (
        <GoThere
          {...(shared === null ? { what: body.name } : { text: `Go to ${shared}`, what: `all bodies of ${shared}, which the file does not keep apart` })}
          go={() => go_to_finding(viewer, { at: null, box: null, bodies: [body.name] })}
        />
      )}
      {holes.length > 0 && (
        <FirstOf class="places" list={holes} step={MANY}>
          {(hole, n) => (
            <PlaceLine key={n} what={`the hole at ${point_text(viewer, hole.at)}`} go={() => go_to_finding(viewer, { at: hole.at, box: box_of(viewer, hole), bodies: [body.name] })}>
              <b>{hole_text(hole, units)}</b>
              <br />
              <span class="faint">
                {plural(hole.edges, "edge")}, closed by {hole.extruded ? "walls and a floor" : "a cap"} of {significant(hole.cap_area, 4)} {units}², at{" "}
                {point_text(viewer, hole.at)}
              </span>
            </PlaceLine>
          )}
        </FirstOf>
      )}
      {body.flips.length > 0 && (
        <>
          <p class="note">Along {plural(body.flips.length, "curve")}, facets face the opposite way from their neighbours:</p>
          <FirstOf class="places" list={body.flips} step={MANY}>
            {(flip, n) => (
              <PlaceLine key={n} what={`the curve at ${point_text(viewer, flip.at)}`} go={() => go_to_finding(viewer, { at: flip.at, box: null, bodies: [body.name] })}>
                {plural(flip.edges, "edge")} <span class="faint">at {point_text(viewer, flip.at)}</span>
              </PlaceLine>
            )}
          </FirstOf>
        </>
      )}
    </div>
  );
}
