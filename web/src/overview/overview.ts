// The 3D overview: mounts into an element, follows the viewer's signals, and takes itself away again. It is loaded when first shown, with
// three.js; nothing else of the page may import it but by import().
import { effect, untracked } from "@preact/signals";
import { words_of } from "../base/messages";
import { returned } from "../server/connection";
import type { Viewer } from "../state/viewer";
import { load_bodies } from "./body_source";
import { HOME, type Orbit, basis, between, fitted, project, straight } from "./camera";
import { make_chrome } from "./chrome";
import { figure, scenery_of } from "./figure";
import { listen_gestures } from "./gestures";
import { type Vec3, from_space, point_to_space, space_of } from "./level_axis";
import { make_pace } from "./pace";
import { type Rest, make_ladder } from "./quality";
import { make_rulers } from "./rulers";
import { follow_slices } from "./slice_source";
import { type Stage, make_stage } from "./stage";
import { on_theme, read_theme } from "./theme";
import { make_triad } from "./triad";
import { draw_picture } from "./writing";
import "./overview.css";

const SETTLE = 160; // ms after the last movement until a sharper picture
const SHARPEST = 800; // and from then to the sharpest, which may take long on a slow machine
const SETTLE_FAR = 1300; // until the sharpest when something else on the page moved: it must not wait for the overview
const TINT = 0.045; // opacity of a plane where nothing is
const MARKER = 9; // pixels around a marker that are its
const FLIGHT = 320; // ms from view to view

export function mount_overview(host: HTMLElement, viewer: Viewer): () => void {
  const space = space_of(viewer.axes);
  const chrome = make_chrome(host);
  let stage: Stage;
  try {
    stage = make_stage(chrome.canvas, space.half);
  } catch {
    chrome.say("The 3D overview needs WebGL 2, which this browser doesn't offer. The other views work without it.");
    chrome.root.dataset.state = "failed";
    return () => chrome.root.remove();
  }

  const abort = new AbortController();
  const ladder = make_ladder();
  let theme = read_theme(chrome.root);
  let aspect = 1;
  let visible = false;
  let lost = false;
  let settle = 0;
  let rest: Rest = 2;
  let flight: { from: Orbit; to: Orbit; began: number; goes_home: boolean } | null = null;

  const point = () => point_to_space(space, viewer.axes.map((axis, d) => axis.centre(viewer.cell.value[d]!)));
  const home = (azimuth = HOME.azimuth, elevation = HOME.elevation) => fitted(space.half, azimuth, elevation, aspect, 0.8);
  const orbit = (): Orbit => {
    const o = viewer.orbit.value;
    return o ? { ...o, target: point_to_space(space, o.target) } : home();
  };
  let own = false; // the orbit changes because it was changed here
  const set_orbit = (to: Orbit | null) => {
    own = true;
    viewer.orbit.value = to && { ...to, target: to.target.map((x, d) => from_space(space, d, x)) as Vec3 };
    own = false;
  };

  const draw = (calm: boolean) => {
    if (!visible || lost) return;
    if (flight) {
      const t = Math.min((performance.now() - flight.began) / FLIGHT, 1);
      set_orbit(between(flight.from, flight.to, t * t * (3 - 2 * t)));
      if (t === 1) {
        if (flight.goes_home) set_orbit(null); // from now on the view follows the panel's size
        flight = null;
      } else move_soon();
    }
    const o = orbit();
    const view = stage.projection(o);
    const at = point();
    stage.set_point(at);
    const { under, over } = figure(view, space.half, scenery_of(viewer, viewer.axes, space, at), theme);
    stage.set_lines(under, over);
    rulers.update(view, at);
    triad.update(view);
    if (calm) slices.update();
    const quality = ladder.quality(rest);
    const ms = stage.draw(o, quality, (rest === 0 && !calm) || rest === 2 || ladder.curious());
    if (ms > 0) {
      ladder.measured(quality, ms);
      pace.cost(ms);
      chrome.root.dataset.frame = ms.toFixed(1);
    }
  };
  const pace = make_pace(draw);
  // What moves is drawn quickly rather than sharply; sharper pictures follow when nothing moves any more.
  const sharpen = (to: Rest, after: number, then?: () => void) => {
    clearTimeout(settle);
    if (ladder.quality(rest) === ladder.quality(2)) return;
    settle = window.setTimeout(() => {
      rest = to;
      if (to === 2) pace.later();
      else pace.soon();
      then?.();
    }, after);
  };
  const move_soon = () => {
    rest = 0;
    sharpen(1, SETTLE, () => sharpen(2, SHARPEST));
    pace.soon();
  };
  const follow_later = () => {
    rest = 0;
    sharpen(2, SETTLE_FAR);
    pace.later();
  };
  const fly = (to: Orbit, goes_home = false) => {
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) set_orbit(goes_home ? null : to);
    else flight = { from: orbit(), to, began: performance.now(), goes_home };
    move_soon();
  };

  const triad = make_triad((axis, above) => {
    // A second time: from the other end, which lies behind the first.
    const there = basis(orbit()).back[axis]! * (above ? 1 : -1) > 0.9999;
    const { azimuth, elevation } = straight(axis, above !== there);
    fly(home(azimuth, elevation));
  });
  const rulers = make_rulers(viewer, space, move_soon);
  const slices = follow_slices(
    viewer,
    abort.signal,
    (axis, picture) => {
      stage.planes.set_picture(axis, picture);
      follow_later();
    },
    (error) => chrome.say(`The slices could not be loaded: ${words_of(error)}.`, () => slices.update()),
  );
  const bring_bodies = () => {
    chrome.root.dataset.state = "loading";
    chrome.busy("Loading the bodies …");
    stage.clear_bodies();
    load_bodies(viewer, space, abort.signal, (bodies) => {
      stage.add_bodies(bodies.surfaces);
      ladder.changed();
      chrome.root.dataset.level = String(bodies.level);
      chrome.root.dataset.triangles = String(bodies.surfaces.reduce((sum, s) => sum + s.indices.length / 3, 0));
      pace.soon();
    })
      .then(() => {
        chrome.busy("");
        chrome.root.dataset.state = "ready";
      })
      .catch((error: unknown) => {
        if (abort.signal.aborted) return;
        chrome.busy("");
        chrome.root.dataset.state = "failed";
        chrome.say(`The bodies could not be loaded: ${words_of(error)}.`, bring_bodies);
      });
  };

  // What failed while the server was away.
  const ask_again = () => {
    chrome.say("");
    if (visible) slices.update();
    if (chrome.root.dataset.state === "failed") bring_bodies();
  };

  const go_home = () => fly(home(), true);
  const stop_gestures = listen_gestures(chrome.canvas, {
    orbit,
    move(to) {
      flight = null;
      set_orbit(to);
      move_soon();
    },
    home: go_home,
    pick(x, y) {
      const p = stage.pick(orbit(), x, y);
      if (!p) return;
      viewer.set_cell([0, 1, 2].map((d) => viewer.axes[d]!.cell_at(from_space(space, d, p[d]!))) as Vec3);
      pace.soon();
    },
  });
  // A marker says what it marks.
  const say_marker = ({ offsetX, offsetY }: PointerEvent) => {
    const view = stage.projection(orbit());
    const under = viewer.markers.value.find((marker) => {
      const p = project(view, point_to_space(space, marker.at));
      return p.far > 0 && Math.hypot(p.x - offsetX, p.y - offsetY) < MARKER;
    });
    chrome.canvas.title = under?.text ?? "";
  };
  chrome.canvas.addEventListener("pointermove", say_marker);
  chrome.on_home(go_home);
  chrome.on_mode((mode) => (viewer.bodies.value = mode));
  chrome.root.append(...rulers.roots, triad.root);

  const paint_theme = () => {
    theme = read_theme(chrome.root);
    for (const d of [0, 1, 2] as const) {
      const [r, g, b] = theme.axes[d];
      stage.planes.set_tint(d, [r * TINT, g * TINT, b * TINT, TINT]);
    }
    pace.soon();
  };
  paint_theme();
  const stop_theme = on_theme(paint_theme);

  // What others change waits for a quiet moment; what is chosen here doesn't.
  const stops = [
    effect(() => {
      stage.set_looks(viewer.looks.value, viewer.bodies.value);
      chrome.show_mode(viewer.bodies.value);
      untracked(move_soon);
    }),
    effect(() => {
      void [viewer.cell.value, viewer.box.value, viewer.markers.value, viewer.measure.value, viewer.orbit.value, viewer.looks.value];
      if (!own) untracked(follow_later);
    }),
    effect(() => {
      void returned.value;
      untracked(ask_again);
    }),
  ];
  const size = new ResizeObserver(([entry]) => {
    const { width, height } = entry!.contentRect;
    const appears = !visible;
    visible = width > 8 && height > 8;
    if (!visible) return;
    aspect = width / height;
    stage.set_size(width, height);
    ladder.changed();
    if (appears) slices.update();
    pace.soon();
  });
  size.observe(chrome.root);

  const on_lost = (event: Event) => {
    event.preventDefault();
    lost = true;
    chrome.say("The graphics card took its memory back; the overview waits for it.");
  };
  const on_restored = () => {
    lost = false;
    chrome.say("");
    pace.soon();
  };
  // Whoever wants the picture elsewhere, too, sends where to: the canvas keeps it for the current task alone.
  const on_draw = (event: Event) => {
    if (!visible || lost) return;
    rest = 2;
    draw(true);
    draw_picture((event as CustomEvent<CanvasRenderingContext2D>).detail, chrome.root, chrome.canvas, theme.ground);
  };
  host.addEventListener("draw", on_draw);
  chrome.canvas.addEventListener("webglcontextlost", on_lost);
  chrome.canvas.addEventListener("webglcontextrestored", on_restored);
  bring_bodies();

  return () => {
    abort.abort();
    clearTimeout(settle);
    pace.stop();
    for (const stop of stops) stop();
    size.disconnect();
    stop_theme();
    stop_gestures();
    host.removeEventListener("draw", on_draw);
    chrome.canvas.removeEventListener("webglcontextlost", on_lost);
    chrome.canvas.removeEventListener("webglcontextrestored", on_restored);
    stage.dispose();
    chrome.root.remove();
  };
}

