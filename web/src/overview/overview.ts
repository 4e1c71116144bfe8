// The overview in three dimensions: it mounts into an element, follows the signals of the viewer, and removes itself
// again. It is loaded together with three.js when it is first shown, so no other part of the page may import it, except
// by import().
import { effect, untracked } from "@preact/signals";
import { words_of } from "../base/messages";
import { returned } from "../server/connection";
import type { Viewer } from "../state/viewer";
import { type Bodies, load_bodies } from "./body_source";
import { basis, project, straight } from "./camera";
import { type Chrome, make_chrome } from "./chrome";
import { figure, scenery_of } from "./figure";
import { listen_gestures } from "./gestures";
import { type Space, type Vec3, from_space, point_to_space, space_of } from "./level_axis";
import { make_pace } from "./pace";
import { make_ladder } from "./quality";
import { type Rulers, make_rulers } from "./rulers";
import { Settling } from "./settling";
import { type SliceSource, follow_slices } from "./slice_source";
import { Stage } from "./stage";
import { type Theme, on_theme, read_theme } from "./theme";
import { type Triad, make_triad } from "./triad";
import { Viewpoint } from "./viewpoint";
import { draw_picture } from "./writing";
import "./overview.css";

const TINT = 0.045; // opacity of a plane where it shows nothing
const MARKER = 9; // pixels around a marker that belong to it

// Returns a function that removes it.
export function mount_overview(host: HTMLElement, viewer: Viewer): () => void {
  const space = space_of(viewer.axes);
  const chrome = make_chrome(host);
  let stage: Stage;
  try {
    stage = new Stage(chrome.canvas, space.half);
  } catch {
    chrome.say("The 3D overview needs WebGL 2, which this browser does not offer. The other views work without it.");
    chrome.root.dataset.state = "failed";
    return () => chrome.root.remove();
  }
  const overview = new Overview(viewer, space, chrome, stage);
  overview.start(host);
  return () => overview.stop();
}

class Overview {
  private readonly abort = new AbortController(); // of requests and listeners
  private readonly stops: (() => void)[] = [];
  private readonly ladder = make_ladder();
  private readonly pace = make_pace((calm) => this.draw(calm));
  private readonly settling = new Settling(this.ladder, this.pace);
  private readonly viewpoint: Viewpoint;
  private readonly triad: Triad;
  private readonly rulers: Rulers;
  private readonly slices: SliceSource;
  private theme: Theme;
  private visible = false;
  private lost = false; // the graphics card took the context back

  constructor(
    private readonly viewer: Viewer,
    private readonly space: Space,
    private readonly chrome: Chrome,
    private readonly stage: Stage,
  ) {
    this.viewpoint = new Viewpoint(viewer, space);
    this.triad = make_triad((axis, above) => this.look_straight(axis, above));
    this.rulers = make_rulers(viewer, space, () => this.settling.moved());
    this.slices = follow_slices(
      viewer,
      this.abort.signal,
      (axis, picture) => {
        stage.planes.set_picture(axis, picture);
        this.settling.followed();
      },
      (error) => chrome.say(`The slices could not be loaded: ${words_of(error)}.`, () => this.slices.update()),
    );
    chrome.root.append(...this.rulers.roots, this.triad.root);
    this.theme = read_theme(chrome.root);
  }

  start(host: HTMLElement): void {
    this.read_colors();
    this.stops.push(on_theme(() => this.read_colors()));
    this.listen(host);
    this.follow_signals();
    this.follow_size();
    this.bring_bodies();
  }

  stop(): void {
    this.abort.abort();
    this.settling.stop();
    this.pace.stop();
    for (const stop of this.stops) stop();
    this.stage.dispose();
    this.chrome.root.remove();
  }

  private listen(host: HTMLElement): void {
    const { canvas } = this.chrome;
    const { signal } = this.abort;
    const go_home = () => this.fly_home();
    this.chrome.on_home(go_home);
    this.chrome.on_mode((mode) => (this.viewer.bodies.value = mode));
    this.stops.push(
      listen_gestures(canvas, {
        orbit: () => this.viewpoint.orbit,
        move: (to) => {
          this.viewpoint.move(to);
          this.settling.moved();
        },
        home: go_home,
        pick: (x, y) => this.pick(x, y),
      }),
    );
    canvas.addEventListener("pointermove", (event) => this.name_marker(event), { signal });
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
        this.stage.set_looks(viewer.looks.value, viewer.bodies.value);
        this.chrome.show_mode(viewer.bodies.value);
        untracked(() => this.settling.moved());
      }),
      effect(() => {
        void [viewer.cell.value, viewer.box.value, viewer.markers.value, viewer.measure.value, viewer.orbit.value, viewer.looks.value];
        if (!this.viewpoint.own) untracked(() => this.settling.followed());
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
      const appears = !this.visible;
      this.visible = width > 8 && height > 8;
      if (!this.visible) return;
      this.viewpoint.aspect = width / height;
      this.stage.set_size(width, height);
      this.ladder.changed();
      if (appears) this.slices.update();
      this.pace.soon();
    });
    observer.observe(this.chrome.root);
    this.stops.push(() => observer.disconnect());
  }

  // `calm`: in a quiet moment of the page, and not because something moves here.
  private draw(calm: boolean): void {
    if (!this.visible || this.lost) return;
    if (this.viewpoint.advance()) this.settling.moved();
    const { viewer, stage, ladder, settling } = this;
    const { orbit } = this.viewpoint;
    const view = stage.projection(orbit);
    const at = point_to_space(this.space, viewer.axes.map((axis, d) => axis.centre(viewer.cell.value[d]!)));
    stage.set_point(at);
    const { under, over } = figure(view, this.space.half, scenery_of(viewer, viewer.axes, this.space, at), this.theme);
    stage.set_lines(under, over);
    this.rulers.update(view, at);
    this.triad.update(view);
    if (calm) this.slices.update();
    const quality = ladder.quality(settling.rest);
    const measured = (settling.rest === 0 && !calm) || settling.rest === 2 || ladder.curious();
    const milliseconds = stage.draw(orbit, quality, measured);
    if (milliseconds === 0) return;
    ladder.measured(quality, milliseconds);
    this.pace.cost(milliseconds);
    this.chrome.root.dataset.frame = milliseconds.toFixed(1);
  }

  // The canvas keeps what WebGL has drawn only for the current task, so it is drawn anew.
  private draw_into(context: CanvasRenderingContext2D): void {
    if (!this.visible || this.lost) return;
    this.settling.rest = 2;
    this.draw(true);
    draw_picture(context, this.chrome.root, this.chrome.canvas, this.theme.ground);
  }

  private read_colors(): void {
    this.theme = read_theme(this.chrome.root);
    for (const d of [0, 1, 2] as const) {
      const [r, g, b] = this.theme.axes[d];
      this.stage.planes.set_tint(d, [r * TINT, g * TINT, b * TINT, TINT]);
    }
    this.pace.soon();
  }

  private fly_home(): void {
    this.viewpoint.fly(this.viewpoint.home(), true);
    this.settling.moved();
  }

  // Looks along an axis from one of its ends, or from the other end if the view is already there: that one lies behind
  // the first.
  private look_straight(axis: number, above: boolean): void {
    const is_there = basis(this.viewpoint.orbit).back[axis]! * (above ? 1 : -1) > 0.9999;
    const { azimuth, elevation } = straight(axis, above !== is_there);
    this.viewpoint.fly(this.viewpoint.home(azimuth, elevation));
    this.settling.moved();
  }

  // Puts the crosshair on what is seen at a pixel.
  private pick(x: number, y: number): void {
    const p = this.stage.pick(this.viewpoint.orbit, x, y);
    if (!p) return;
    this.viewer.set_cell([0, 1, 2].map((d) => this.viewer.axes[d]!.cell_at(from_space(this.space, d, p[d]!))) as Vec3);
    this.pace.soon();
  }

  // The marker under the pointer says what it marks.
  private name_marker({ offsetX, offsetY }: PointerEvent): void {
    const view = this.stage.projection(this.viewpoint.orbit);
    const under = this.viewer.markers.value.find((marker) => {
      const p = project(view, point_to_space(this.space, marker.at));
      return p.far > 0 && Math.hypot(p.x - offsetX, p.y - offsetY) < MARKER;
    });
    this.chrome.canvas.title = under?.text ?? "";
  }

  private bring_bodies(): void {
    const { chrome, stage } = this;
    chrome.root.dataset.state = "loading";
    chrome.busy("Loading the bodies …");
    stage.clear_bodies();
    load_bodies(this.viewer, this.space, this.abort.signal, (bodies) => this.show_bodies(bodies))
      .then(() => {
        chrome.busy("");
        chrome.root.dataset.state = "ready";
      })
      .catch((error: unknown) => {
        if (this.abort.signal.aborted) return;
        chrome.busy("");
        chrome.root.dataset.state = "failed";
        chrome.say(`The bodies could not be loaded: ${words_of(error)}.`, () => this.bring_bodies());
      });
  }

  private show_bodies({ level, surfaces }: Bodies): void {
    this.stage.add_bodies(surfaces);
    this.ladder.changed();
    const { dataset } = this.chrome.root; // for tests and measurements
    dataset.level = String(level);
    dataset.triangles = String(surfaces.reduce((sum, s) => sum + s.indices.length / 3, 0));
    this.pace.soon();
  }

  // The server is back: what failed while it was away is asked for again.
  private ask_again(): void {
    this.chrome.say("");
    if (this.visible) this.slices.update();
    if (this.chrome.root.dataset.state === "failed") this.bring_bodies();
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
