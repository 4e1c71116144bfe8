// The overview in three dimensions: it mounts into an element, follows the signals of the viewer, and removes itself
// again. It is loaded together with three.js when it is first shown, so no other part of the page may import it, except
// by import().
//
// What is seen comes from the server, which follows the line of sight of each pixel through the grid: so the picture is
// right for any grid, however many cells it has, and however near the camera is. While the camera moves, the newest
// picture is drawn as points in space, until the next one has come.
import { effect, untracked } from "@preact/signals";
import { say, words_of } from "../base/messages";
import { returned } from "../server/connection";
import { on_theme } from "../state/theme";
import type { Viewer } from "../state/viewer";
import type { Range } from "../state/zoom";
import { type Orbit, basis, dollied, dollied_to, dot, project, straight } from "./space/camera";
import { type Chrome, make_chrome } from "./chrome";
import { figure, scenery_of } from "./figure";
import { point_at } from "./frame";
import { keys_of, listen_gestures } from "./gestures";
import { Hover } from "./hover";
import { make_lengths } from "./lengths";
import { make_measuring } from "./measuring";
import { make_pace } from "./pace";
import { make_ladder } from "./quality";
import { make_rulers } from "./rulers";
import { make_scale_bar } from "./scale_bar";
import { type Aim, SightSource } from "./sight_source";
import { difference_of } from "./sight/difference";
import type { Seen } from "./sight/query";
import { type SightSubject, bodies_of } from "./sight/subject";
import { type Space, type Vec3, from_space, point_to_space, shortest_side, space_of } from "./space/space";
import { Stage } from "./stage";
import { type Theme, read_theme } from "./theme";
import { make_triad } from "./triad";
import { Viewpoint } from "./space/viewpoint";
import { draw_picture } from "./writing";

const MARKER = 9; // pixels around a marker that belong to it
const SETTLE = 160; // milliseconds after the last movement until the sharp picture is asked for
const SAME_PLACE = 400; // milliseconds in which turns of the wheel go to the same point
const NEAREST = 3; // cells between the camera and what it moves to
const CLOSER = 0.4; // of the distance, by a double click

// What keys do in it, and a function that removes it. It shows the viewer's bodies, or how those of
// another one differ from them.
export interface Looked {
  readonly against?: Viewer | undefined;
  readonly cut_by?: Viewer | undefined; // at whose crosshair bodies are cut
}
export function mount_overview(host: HTMLElement, viewer: Viewer, { against, cut_by = viewer }: Looked = {}): { keys: Record<string, () => void>; unmount: () => void } {
  const space = space_of(viewer.bounds);
  const chrome = make_chrome(host);
  let stage: Stage;
  try {
    stage = new Stage(chrome.canvas, space.half);
  } catch {
    chrome.say("The 3D overview needs WebGL 2, which this browser does not offer. The other views work without it.");
    chrome.root.dataset.state = "failed";
    return { keys: {}, unmount: () => chrome.root.remove() };
  }
  const overview = new Overview(viewer, space, against ? difference_of(viewer, against, space) : bodies_of(viewer, space, cut_by), chrome, stage);
  overview.start(host);
  return { keys: keys_of(overview), unmount: () => overview.stop() };
}

class Overview {
  private readonly abort = new AbortController(); // of requests and listeners
  private readonly stops: (() => void)[] = [];
  private readonly ladder = make_ladder();
  private readonly pace = make_pace((calm) => this.draw(calm));
  readonly viewpoint: Viewpoint;
  private readonly triad = make_triad((axis, above) => this.look_straight(axis, above));
  private readonly rulers: ReturnType<typeof make_rulers>;
  private readonly bar: ReturnType<typeof make_scale_bar>;
  private readonly sights: SightSource;
  readonly hover: Hover;
  private readonly measuring: ReturnType<typeof make_measuring>;
  private readonly lengths: ReturnType<typeof make_lengths>;
  private readonly nearest: number;
  private theme: Theme;
  private visible = false;
  private lost = false; // the graphics card took the context back
  private moving = false;
  private settle = 0; // a timer
  private damaged = false; // the last sharp picture shows what can't be read
  private clicks = Promise.resolve();
  private aim: Aim | null = null;
  private drawn_from = ""; // the place of the last frame
  private wheel: { point: Vec3 | null; x: number; y: number; time: number } | null = null;

  constructor(
    private readonly viewer: Viewer,
    private readonly space: Space,
    private readonly subject: SightSubject,
    private readonly chrome: Chrome,
    private readonly stage: Stage,
  ) {
    this.viewpoint = new Viewpoint(viewer, space);
    this.nearest = NEAREST * shortest_side(space, viewer.axes);
    this.rulers = make_rulers(viewer, space, () => this.moved());
    this.bar = make_scale_bar(viewer.info.units);
    this.measuring = make_measuring(viewer, this.abort.signal, () => this.pace.soon());
    this.lengths = make_lengths(viewer, space);
    this.sights = new SightSource(subject, this.abort.signal, {
      quick: (frame) => {
        stage.cloud.set(frame);
        this.came("ready");
      },
      sharp: (frame, done) => {
        stage.still.set(frame);
        this.came(done ? "sharp" : "ready");
      },
      failed: (error) => {
        chrome.root.dataset.state = "failed";
        chrome.busy.textContent = "";
        chrome.say(`What is seen could not be loaded: ${words_of(error)}.`, () => this.ask_again());
      },
    });
    this.hover = new Hover(
      (label) => subject.name_of(label),
      (x, y, signal) => this.seen_at(x, y, signal),
      (seen) => {
        const hover = viewer.hover.peek();
        if (seen) viewer.hover.value = { axis: null, cell: seen.cell, point: [...seen.at], labels: seen.label === null || seen.grid !== viewer ? null : [viewer.keeps_bodies ? seen.label : seen.material!] };
        else if (hover?.axis === null) viewer.hover.value = null;
      },
    );
    chrome.root.append(...this.rulers.roots, this.triad.root, this.bar.root, this.lengths.root, this.hover.root);
    this.theme = read_theme(chrome.root);
  }

  start(host: HTMLElement): void {
    this.chrome.root.dataset.state = "loading";
    this.chrome.busy.textContent = "Loading …";
    this.stops.push(on_theme(() => this.read_colors()));
    this.listen(host);
    this.follow_signals();
    this.follow_size();
  }

  stop(): void {
    this.abort.abort();
    clearTimeout(this.settle);
    this.hover.hide();
    this.pace.stop();
    for (const stop of this.stops) stop();
    this.stage.dispose();
    this.chrome.root.remove();
  }

  private listen(host: HTMLElement): void {
    const { canvas } = this.chrome;
    const { signal } = this.abort;
    this.chrome.home.addEventListener("click", () => this.fly_home());
    for (const { mode, button } of this.chrome.modes)
      button.addEventListener("click", () => {
        if (mode === "plane") this.viewer.plane_normal.value = basis(this.viewpoint.orbit).back;
        this.viewer.bodies.value = mode;
      });
    this.chrome.sky.addEventListener("click", () => (this.viewer.sky.value = this.viewer.sky.value === 2 ? 1 : 2));
    this.stops.push(listen_gestures(canvas, this));
    canvas.addEventListener("webglcontextlost", (event) => this.lose(event), { signal });
    canvas.addEventListener("webglcontextrestored", () => this.restore(), { signal });
    // A picture of all views asks for this one with an event that says where to draw it.
    host.addEventListener("draw", (event) => this.draw_into((event as CustomEvent<CanvasRenderingContext2D>).detail), { signal });
  }

  // What others change waits for a quiet moment; what is chosen here does not.
  private follow_signals(): void {
    const { viewer } = this;
    this.stops.push(
      effect(() => {
        void [viewer.shown_looks.value, viewer.small.value, viewer.bodies.value, viewer.plane_normal.value];
        this.chrome.show_mode(viewer.bodies.value);
        untracked(() => {
          this.sights.recolor();
          this.moved();
        });
      }),
      effect(() => {
        this.chrome.show_sky(viewer.sky.value);
        untracked(() => this.moved());
      }),
      effect(() => {
        void [viewer.box.value, viewer.isolated.value, viewer.markers.value, viewer.measures.value, viewer.chosen.value];
        untracked(() => this.pace.later());
      }),
      effect(() => {
        void [viewer.cell.value, viewer.orbit.value, this.subject.cuts()];
        if (!this.viewpoint.own) untracked(() => (viewer.compared ? this.moved() : this.pace.later())); // both that are compared move as one
      }),
      effect(() => {
        const visit = viewer.visited.value;
        if (visit && this.visible) untracked(() => this.fly_to(visit));
      }),
      effect(() => {
        void returned.value;
        untracked(() => this.ask_again());
      }),
    );
  }

  private follow_size(): void {
    const observer = new ResizeObserver(([entry]) => {
      const { width, height } = entry!.contentRect;
      const was_visible = this.visible;
      this.visible = width > 8 && height > 8;
      if (!this.visible) return;
      this.viewpoint.aspect = width / height;
      const visit = this.viewer.visited.peek();
      if (visit && !was_visible) this.fly_to(visit, false); // nobody has seen from where
      this.stage.set_size(width, height);
      this.ladder.changed();
      this.pace.soon();
    });
    observer.observe(this.chrome.root);
    this.stops.push(() => observer.disconnect());
  }

  // Something moves here: it is drawn with the next frame, and sharply once it has come to rest.
  private moved(): void {
    this.moving = true;
    clearTimeout(this.settle);
    this.settle = window.setTimeout(() => {
      this.moving = false;
      this.pace.soon();
    }, SETTLE);
    this.pace.soon();
  }

  // A picture has come.
  private came(state: "ready" | "sharp"): void {
    this.chrome.root.dataset.state = state;
    this.chrome.busy.textContent = "";
    this.damaged = state === "sharp" ? this.stage.shown!.label.includes(this.subject.unreadable() + 1) : this.damaged;
    this.chrome.say(this.damaged ? "A part of the file can't be read. It is striped here." : "");
    this.pace.soon();
  }

  move(to: Orbit): void {
    this.viewpoint.move(to);
    this.moved();
  }

  // Towards what is seen at a pixel, and no farther than to it.
  dolly(factor: number, x?: number, y?: number): void {
    const { orbit } = this.viewpoint;
    if (x === undefined || y === undefined) return this.move(dollied(orbit, factor, this.nearest));
    const now = performance.now();
    const is_same = this.wheel && now - this.wheel.time < SAME_PLACE && Math.hypot(this.wheel.x - x, this.wheel.y - y) < 3;
    const point = is_same ? this.wheel!.point : (this.pixel_at(x, y)?.point ?? null);
    this.wheel = { point, x, y, time: now };
    this.move(point ? dollied_to(orbit, point, factor, this.nearest) : dollied(orbit, factor, this.nearest));
  }

  // `calm`: in a quiet moment of the page, and not because something moves here.
  private draw(calm: boolean): void {
    if (!this.visible || this.lost) return;
    if (this.viewpoint.advance()) this.moved();
    const { viewer, stage, ladder } = this;
    const { orbit } = this.viewpoint;
    const view = stage.projection(orbit);
    const at = point_to_space(this.space, viewer.centre_of(viewer.cell.value));
    this.look(orbit, view.width, view.height, calm);
    const { under, over } = figure(view, this.space.half, scenery_of(viewer, viewer.axes, this.space, at), this.theme);
    stage.set_lines(under, over);
    this.rulers.update(view, at);
    this.triad.update(view);
    this.lengths.update(view);
    this.bar.update(view, orbit.distance, this.space.scale);
    const quality = ladder.quality();
    const milliseconds = stage.draw(orbit, quality, this.moving && !calm);
    if (milliseconds === 0) return;
    ladder.measured(quality, milliseconds);
    this.pace.cost(milliseconds);
    this.chrome.root.dataset.frame = milliseconds.toFixed(1);
  }

  // Asks for what is to be seen now.
  private look(orbit: Orbit, width: number, height: number, calm: boolean): void {
    this.aim = { orbit, width: Math.round(width), height: Math.round(height), cuts: this.subject.cuts(), points: this.ladder.quality().points };
    const place = JSON.stringify([orbit, this.aim.cuts, width, height]);
    if (place !== this.drawn_from) {
      this.stage.leave(this.chrome.root.dataset.state === "sharp");
      if (this.chrome.root.dataset.state === "sharp") this.chrome.root.dataset.state = "ready";
      this.drawn_from = place;
    }
    this.sights.want(this.aim, !this.moving || calm);
  }

  // The canvas keeps what WebGL has drawn only for the current task, so it is drawn anew.
  private draw_into(context: CanvasRenderingContext2D): void {
    if (!this.visible || this.lost) return;
    this.draw(true);
    draw_picture(context, this.chrome.root, this.chrome.canvas, this.theme.ground);
  }

  private read_colors(): void {
    this.theme = read_theme(this.chrome.root);
    this.pace.soon();
  }

  fly_home(): void {
    this.viewpoint.fly(this.viewpoint.home(), true);
    this.moved();
  }

  // So near that a box fills the view, or to where a point is in sight.
  private fly_to(box: [Range, Range, Range], slowly = true): void {
    this.viewer.visited.value = null;
    const [low, high] = [point_to_space(this.space, box.map(({ min }) => min)), point_to_space(this.space, box.map(({ max }) => max))];
    const is_point = box.every(({ min, max }) => min === max);
    if (is_point && this.viewpoint.sees(low)) return;
    const to = is_point ? { ...this.viewpoint.orbit, target: low } : this.viewpoint.framing(low, high, this.nearest);
    if (slowly) this.viewpoint.fly(to);
    else this.viewpoint.move(to);
    this.moved();
  }

  // Looks along an axis from one of its ends, or from the other end if the view is already there: that one lies behind
  // the first.
  private look_straight(axis: number, above: boolean): void {
    const { orbit } = this.viewpoint;
    const is_there = basis(orbit).back[axis]! * (above ? 1 : -1) > 0.9999;
    const { azimuth, elevation } = straight(axis, above !== is_there, orbit.sky);
    this.viewpoint.fly(this.viewpoint.home(azimuth, elevation));
    this.moved();
  }

  // What the picture that is shown has at a pixel of the panel. Null when that picture is not of what is to be seen.
  private pixel_at(x: number, y: number): { label: number | null; point: Vec3 | null } | null {
    const frame = this.stage.shown;
    if (!frame || !this.aim || JSON.stringify(frame.orbit) !== JSON.stringify(this.aim.orbit)) return null;
    const [px, py] = [Math.floor((x / this.aim.width) * frame.width), Math.floor((y / this.aim.height) * frame.height)];
    if (px < 0 || py < 0 || px >= frame.width || py >= frame.height) return null;
    const label = frame.label[py * frame.width + px]!;
    return { label: label === 0 ? null : label - 1, point: point_at(frame, px, py) };
  }

  private coordinates_at(x: number, y: number): Vec3 | null {
    const point = this.pixel_at(x, y)?.point;
    return point ? (point.map((p, d) => from_space(this.space, d, p)) as Vec3) : null;
  }

  private async seen_at(x: number, y: number, signal: AbortSignal): Promise<Seen | null> {
    return this.aim && this.subject.seen_at(this.aim, x, y, signal);
  }

  // The marker under the pointer says what it marks; otherwise the body there has a name.
  name_what_is_at(x: number, y: number): void {
    const view = this.stage.projection(this.viewpoint.orbit);
    const under = this.viewer.marks.value.find((marker) => {
      const p = project(view, point_to_space(this.space, marker.at));
      return p.far > 0 && Math.hypot(p.x - x, p.y - y) < MARKER;
    });
    this.chrome.canvas.title = under?.text ?? "";
    this.measuring.move(this.coordinates_at(x, y));
    if (under) this.hover.hide();
    else this.hover.show(x, y, this.pixel_at(x, y)?.label ?? null, view.width);
  }

  // A click keeps the cell in the read-out, or measures. One click after another, whichever answer comes first.
  click(x: number, y: number, shift: boolean): void {
    const seen = this.seen_at(x, y, this.abort.signal);
    this.clicks = this.clicks.then(async () => {
      try {
        await this.clicked(await seen, shift);
      } catch (error) {
        if (!this.abort.signal.aborted) say(`What is there can't be told: ${words_of(error)}.`);
      }
    });
  }
  private async clicked(seen: Seen | null, shift: boolean): Promise<void> {
    if (this.abort.signal.aborted) return;
    if (shift) await this.measuring.thickness(seen);
    else if (this.viewer.tool.value === "measure") this.measuring.click(seen);
    else if (!seen || seen.grid === this.viewer) this.viewer.pinned.value = seen && seen.cell;
  }

  // Puts the crosshair on what is seen at a pixel, and moves the camera closer.
  async go_to(x: number, y: number): Promise<void> {
    const orbit = this.viewpoint.orbit;
    const seen = await this.seen_at(x, y, this.abort.signal).catch(() => null);
    if (!seen || this.viewer.tool.value === "measure") return; // its clicks have measured
    this.viewer.pinned.value = null;
    if (seen.grid === this.viewer) this.viewer.go_to_cell(seen.cell);
    else this.viewer.go_to(seen.at);
    const target = point_to_space(this.space, seen.at);
    const { back } = basis(orbit);
    const away = dot([0, 1, 2].map((d) => orbit.target[d]! + orbit.distance * back[d]! - target[d]!) as Vec3, back);
    this.viewpoint.fly({ ...orbit, target, distance: Math.max(CLOSER * away, 8 * this.nearest) });
    this.moved();
  }

  // The server is back: what failed while it was away is asked for again.
  private ask_again(): void {
    this.chrome.say("");
    if (this.chrome.root.dataset.state !== "failed") return;
    this.chrome.root.dataset.state = "loading";
    this.sights.again();
  }

  private lose(event: Event): void {
    event.preventDefault(); // otherwise the browser never restores it
    this.lost = true;
    this.chrome.say("The browser has lost access to the graphics card. The overview returns as soon as access does.");
  }

  private restore(): void {
    this.lost = false;
    this.chrome.say("");
    this.pace.soon();
  }
}

