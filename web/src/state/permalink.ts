// The state of the page as its address. It stands behind '#', so that a link shows what its sender saw and the state is
// never sent to the server. People can read it: #g=nefertiti&at=5000,4000,3000&look=0.5,1.25,-3&zoom=2.5&layout=z ...
// It holds where the views look and, of everything else, only what differs from the start. Numbers are written so
// that they are read back unchanged.
import { batch, effect } from "@preact/signals";
import { AXIS_NAMES, type AxisIndex, type Index3 } from "../base/grid";
import { is_refinement } from "../base/refinement";
import { hex_color, rgb_of_color, same_look } from "../base/materials";
import { say } from "../base/messages";
import { numbers_in, ranges } from "../base/ranges";
import { with_change } from "./bodies";
import { comparison_in, write_comparison } from "./comparison";
import { measures_in_address, next_id, parsed_measure, put_measure } from "./measures";
import { beyond_reach, outside_box, outside_cell, outside_point } from "./outside";
import { places_found } from "./places";
import type { Isolation } from "./isolation";
import { BODY_MODES, type BodyMode, type Box, type Layout, type Panel, type Viewer } from "./viewer";

export const query_in_address = (): URLSearchParams => new URLSearchParams(location.hash.slice(1));
export const grid_in_address = (): string | null => query_in_address().get("g");

const numbers = (text: string | null, count: number): number[] | null => {
  const list = text?.split(",").map((n) => (/^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(n.trim()) ? Number(n) : Number.NaN));
  return list && list.length === count && list.every(Number.isFinite) ? list : null;
};

const LAYOUTS: readonly Layout[] = ["four", "x", "y", "z", "3d"];
const PANELS: readonly Panel[] = ["materials", "bodies", "report", "box", "leaves", "share", "status"];
const SWITCHES = { axes: "show_axes", scale: "show_scale", lines: "show_lines", outline: "show_outline", shares: "show_shares", leaves: "show_leaves" } as const;

const parsed_color = (text: string | undefined) => (/^[0-9a-f]{6}$/.test(text ?? "") ? rgb_of_color(`#${text}`) : null);

function parsed_opacity(text: string | undefined): number | null {
  const opacity = text ? Number(text) : Number.NaN;
  return opacity >= 0 && opacity <= 1 ? opacity : null;
}

// hidden=labels as ranges; body=labels:rrggbb:opacity, joined by ';', where colour or opacity may be empty.
function read_bodies(viewer: Viewer, query: URLSearchParams): void {
  const count = viewer.labels.length;
  let looks = with_change(new Map(), numbers_in(query.get("hidden") ?? "", count), () => ({ visible: false }));
  for (const text of query.get("body")?.split(";") ?? []) {
    const [labels, color, opacity] = text.split(":");
    const [rgb, alpha] = [parsed_color(color), parsed_opacity(opacity)];
    looks = with_change(looks, numbers_in(labels ?? "", count), () => ({ ...(rgb && { color: rgb }), ...(alpha !== null && { opacity: alpha }) }));
  }
  viewer.body_looks.value = looks;
}

// The parts of the address for what bodies look like. They are kept, because the address is made anew whenever a view moves, and there may
// be 10^5 bodies.
let kept: { looks: Viewer["body_looks"]["value"]; hidden: string; body: string } | null = null;

function put_bodies(viewer: Viewer, start: URLSearchParams): void {
  if (kept?.looks !== viewer.body_looks.value) kept = { looks: viewer.body_looks.value, ...bodies_in_address(viewer.body_looks.value) };
  if (kept.hidden) start.set("hidden", kept.hidden);
  if (kept.body) start.set("body", kept.body);
}

function bodies_in_address(of: Viewer["body_looks"]["value"]): { hidden: string; body: string } {
  const looks = [...of].sort(([a], [b]) => a - b);
  const hidden = looks.flatMap(([label, { visible }]) => (visible === false ? [label] : []));
  const alike = new Map<string, number[]>(); // labels of the same look
  for (const [label, { color, opacity }] of looks) {
    const look = `${color ? hex_color({ color }).slice(1) : ""}:${opacity ?? ""}`;
    if (look === ":") continue;
    const labels = alike.get(look);
    if (labels) labels.push(label);
    else alike.set(look, [label]);
  }
  return { hidden: ranges(hidden), body: [...alike].map(([look, labels]) => `${ranges(labels)}:${look}`).join(";") };
}

// only=labels as ranges, perhaps none; found=the box of what was found in them.
function isolation_in(query: URLSearchParams, viewer: Viewer): Isolation | null {
  const only = query.get("only");
  const found = numbers(query.get("found"), 6);
  const box = found?.every(Number.isInteger) && !outside_box(viewer.axes, found) ? (found as Box) : null;
  const labels = [...new Set(numbers_in(only ?? "", viewer.labels.length))].sort((a, b) => a - b);
  return only !== null && (labels.length > 0 || box) ? { labels, box } : null;
}

const say_if = (text: string | null) => text !== null && say(text);

// Puts the state in the address into the viewer. What is missing there, or makes no sense, stays as it is.
export function read_address(viewer: Viewer): void {
  const query = query_in_address();
  const look = numbers(query.get("look"), 3);
  const zoom = numbers(query.get("zoom"), 1);
  batch(() => {
    const at = numbers(query.get("at"), 3);
    if (at) {
      viewer.set_cell(at as Index3);
      say_if(outside_cell(viewer.axes, at));
    }
    const compare = (viewer.compare.value = comparison_in(query, viewer));
    if (look) {
      // The other grid of a comparison may reach farther.
      viewer.centre.value = viewer.axes.map((axis, d) => (compare ? look[d]! : axis.inside(look[d]!))) as [number, number, number];
      if (!compare) say_if(outside_point(viewer.axes, look, viewer.units));
    }
    if (zoom && zoom[0]! > 0) viewer.zoom.value = zoom[0]!;
    const layout = query.get("layout") as Layout | null;
    if (layout && LAYOUTS.includes(layout)) viewer.layout.value = layout;
    const panel = query.get("panel");
    if (panel === "none") viewer.panel.value = null;
    else if (panel && PANELS.includes(panel as Panel) && (panel !== "bodies" || viewer.keeps_bodies)) viewer.panel.value = panel as Panel;
    for (const [key, name] of Object.entries(SWITCHES)) {
      const value = query.get(key);
      if (value === "0" || value === "1") viewer[name].value = value === "1";
    }
    const refine = numbers(query.get("refine"), 2);
    const { coarsest, layers } = viewer.standard_refinement;
    const [m, n] = refine && is_refinement(refine[0]!, refine[1]!) ? (refine as [number, number]) : [coarsest, layers];
    if (refine || query.has("want")) viewer.refinement.value = { coarsest: m, layers: n, want: query.get("want") ?? "" };
    const box = numbers(query.get("box"), 6);
    if (box?.every(Number.isInteger)) {
      const outside = outside_box(viewer.axes, box);
      if (!outside) viewer.box.value = box as Box;
      say_if(outside);
    }
    const pin = numbers(query.get("pin"), 3);
    if (pin?.every(Number.isInteger)) {
      viewer.pinned.value = viewer.axes.map((axis, d) => axis.clamp(pin[d]!)) as Index3;
      say_if(outside_cell(viewer.axes, pin));
    }
    const orbit = numbers(query.get("orbit"), 6);
    if (orbit && Math.abs(orbit[1]!) <= 90 && orbit[2]! > 0) {
      const [azimuth, elevation, distance, ...target] = orbit as [number, number, number, number, number, number];
      const beyond = beyond_reach(viewer.axes, "The camera", [distance, ...target]);
      if (!beyond) viewer.orbit.value = { azimuth, elevation, distance, target };
      say_if(beyond);
    }
    if (query.get("marks") === "1") viewer.markers.value = places_found(viewer.info);
    const bodies = query.get("bodies") as BodyMode | null;
    if (bodies && BODY_MODES.includes(bodies)) viewer.bodies.value = bodies;
    const plane = numbers(query.get("plane"), 3);
    const steepest = Math.max(...(plane ?? []).map(Math.abs));
    if (steepest > 0) viewer.plane_normal.value = plane!.map((n) => (steepest > 1e6 || steepest < 1e-6 ? n / steepest : n)) as [number, number, number];
    const oblique = ["x", "y", "z"].indexOf(query.get("oblique") ?? "");
    if (oblique >= 0) viewer.oblique.value = oblique as AxisIndex;
    const up = query.get("up");
    if (up === "y" || up === "z") viewer.sky.value = up === "y" ? 1 : 2;
    for (const text of query.get("measure")?.split(";") ?? []) {
      const measure = parsed_measure(text, next_id(viewer.measures.value));
      const beyond = measure && beyond_reach(viewer.axes, "A measured line", [...measure.from, ...measure.to]);
      if (measure && !beyond) put_measure(viewer, measure);
      say_if(beyond);
    }
    // material=id:rrggbb:opacity:visible, joined by ';'
    const looks = [...viewer.looks.value];
    for (const text of query.get("material")?.split(";") ?? []) {
      const [id, color, opacity, visible] = text.split(":");
      const n = Number(id);
      const [rgb, alpha] = [parsed_color(color), parsed_opacity(opacity)];
      if (looks[n] && rgb && alpha !== null) looks[n] = { color: rgb, opacity: alpha, visible: visible === "1" };
    }
    viewer.looks.value = looks;
    if (viewer.keeps_bodies) read_bodies(viewer, query);
    viewer.isolated.value = isolation_in(query, viewer);
  });
}

export function address_of(viewer: Viewer): string {
  const start = new URLSearchParams({ g: viewer.info.id, at: viewer.cell.value.join(","), look: viewer.centre.value.join(",") });
  if (viewer.zoom.value > 0) start.set("zoom", String(viewer.zoom.value));
  if (viewer.layout.value !== "four") start.set("layout", viewer.layout.value);
  if (viewer.compare.value) write_comparison(start, viewer.compare.value);
  if (viewer.panel.value !== "materials") start.set("panel", viewer.panel.value ?? "none");
  const standard = viewer.standard_switches;
  for (const [key, name] of Object.entries(SWITCHES)) if (viewer[name].value !== standard[name]) start.set(key, viewer[name].value ? "1" : "0");
  const { coarsest, layers, want } = viewer.refinement.value;
  if (coarsest !== viewer.standard_refinement.coarsest || layers !== viewer.standard_refinement.layers) start.set("refine", `${coarsest},${layers}`);
  if (want) start.set("want", want);
  if (viewer.box.value) start.set("box", viewer.box.value.join(","));
  if (viewer.pinned.value) start.set("pin", viewer.pinned.value.join(","));
  if (viewer.markers.value.length) start.set("marks", "1");
  const o = viewer.orbit.value;
  if (o) start.set("orbit", [o.azimuth, o.elevation, o.distance, ...o.target].map((x) => Number(x.toPrecision(6))).join(","));
  if (viewer.bodies.value !== "cut") start.set("bodies", viewer.bodies.value);
  if (viewer.oblique.value !== null) start.set("oblique", AXIS_NAMES[viewer.oblique.value]);
  if ((viewer.bodies.value === "plane" || viewer.oblique.value !== null) && viewer.plane_normal.value)
    start.set("plane", viewer.plane_normal.value.map((x) => Number(x.toPrecision(6))).join(","));
  if (viewer.sky.value !== viewer.standard_sky) start.set("up", viewer.sky.value === 1 ? "y" : "z");
  if (viewer.measures.value.length) start.set("measure", measures_in_address(viewer.measures.value));
  const changed = viewer.looks.value.flatMap((look, id) => {
    return same_look(look, viewer.standard_looks[id]!) ? [] : [`${id}:${hex_color(look).slice(1)}:${look.opacity}:${look.visible ? 1 : 0}`];
  });
  if (changed.length) start.set("material", changed.join(";"));
  put_bodies(viewer, start);
  const isolated = viewer.isolated.value;
  if (isolated) start.set("only", ranges(isolated.labels));
  if (isolated?.box) start.set("found", isolated.box.join(","));
  return `#${start.toString().replaceAll("%2C", ",").replaceAll("%3A", ":").replaceAll("%3B", ";")}`;
}

// Keeps the address up to date, with a short delay, because browsers limit how often it may change. Returns a function
// that ends this.
export function keep_address(viewer: Viewer): () => void {
  let timer = 0;
  let here = location.href;
  const arrive = () => void (here = location.href);
  const stop = effect(() => {
    const address = address_of(viewer);
    clearTimeout(timer);
    timer = window.setTimeout(() => {
      // After "back" the browser is at another entry of its history before it says so by "hashchange". What was to be
      // written into the entry that was left must not be written into that one, or the page would stay where it is.
      if (location.href !== here) return;
      history.replaceState(null, "", address);
      arrive();
    }, 250);
  });
  addEventListener("hashchange", arrive);
  return () => {
    clearTimeout(timer);
    removeEventListener("hashchange", arrive);
    stop();
  };
}
