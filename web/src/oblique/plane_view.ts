// The oblique view: the slice along a plane through the crosshair, of any direction. It follows the signals of the viewer. While the plane moves, the last
// picture stays where it was, until another has come.
import { effect } from "@preact/signals";
import { AXES, type Index3, for_axes } from "../base/grid";
import { length_text, round_length } from "../base/lengths";
import { words_of } from "../base/messages";
import { returned } from "../server/connection";
import { on_theme } from "../state/theme";
import type { Viewer } from "../state/viewer";
import { fitting_zoom } from "../state/zoom";
import { Palette, SetTable } from "../tiles/sets";
import { type Ink, read_ink } from "../views/drawing/ink";
import { FONT } from "../views/drawing/pen";
import { type PlaneFrame, SLICE_NORMALS, type Vec3, cross, dot, onto, outline_of, plane_frame, plus } from "./frame";
import { type PlaneAim, type PlanePicture, PlaneSource, plane_query } from "./plane_source";

const REST = 140; // milliseconds without a change, after which the sharp picture is asked for
const FINEST = 2; // device pixels per CSS pixel
const BAR = 130; // CSS pixels of the longest scale bar

export interface PlaneState {
  readonly waiting: boolean; // for the sharp picture
  readonly damaged: boolean; // parts of it can't be read
  readonly trouble: string; // why there is none; empty: there is
}

// The plane that the signals say. Without a normal it is the slice whose place it takes.
export const frame_in = (viewer: Viewer): PlaneFrame =>
  plane_frame(viewer.plane_normal.value ?? SLICE_NORMALS[viewer.oblique.value ?? 2], viewer.centre_of(viewer.cell.value));

export class PlaneView {
  readonly cells = document.createElement("canvas");
  readonly lines = document.createElement("canvas");
  private readonly sets = new SetTable();
  private readonly palette = new Palette(this.sets);
  private readonly source: PlaneSource;
  private readonly picture_canvas = document.createElement("canvas");
  private readonly stops: (() => void)[] = [];
  private picture: PlanePicture | null = null;
  private sharp_query = ""; // of the picture, where all of it has come
  private told: PlaneState = { waiting: true, damaged: false, trouble: "" };
  private painted = -1; // the palette's version in picture_canvas; -1: anew
  private ink: Ink | null = null;
  private width = 0; // CSS pixels
  private height = 0;
  private request = 0;
  private timer = 0;
  private at_rest = true;

  constructor(
    private readonly viewer: Viewer,
    private readonly host: HTMLElement,
    private readonly says: (state: PlaneState) => void,
  ) {
    this.cells.className = "view-cells";
    this.lines.className = "view-overlay";
    host.prepend(this.cells, this.lines);
    this.source = new PlaneSource(viewer.address, this.sets, {
      shows: (picture, sharp) => {
        this.picture = picture;
        this.painted = -1;
        this.sharp_query = sharp ? plane_query(picture.aim) : "";
        this.tell({ ...this.told, damaged: picture.damaged.length > 0, trouble: "" });
        this.invalidate();
      },
      failed: (error) => this.tell({ waiting: false, damaged: false, trouble: words_of(error) }),
    });
    const sizes = new ResizeObserver(() => {
      this.width = host.clientWidth;
      this.height = host.clientHeight;
      this.invalidate();
    });
    sizes.observe(host);
    this.stops.push(
      () => sizes.disconnect(),
      on_theme(() => {
        this.ink = null;
        this.invalidate();
      }),
      effect(() => {
        for (const s of [viewer.shown_looks, viewer.show_axes, viewer.show_scale, viewer.pinned]) s.value;
        this.invalidate();
      }),
      effect(() => {
        for (const s of [viewer.cell, viewer.centre, viewer.zoom, viewer.plane_normal]) s.value;
        this.moved();
      }),
      effect(() => void (returned.value > 0 && this.source.again())),
    );
  }

  stop(): void {
    cancelAnimationFrame(this.request);
    clearTimeout(this.timer);
    for (const stop of this.stops) stop();
    this.source.close();
    this.cells.remove();
    this.lines.remove();
  }

  again(): void {
    this.tell({ ...this.told, waiting: true, trouble: "" });
    this.source.again();
  }

  // The point of the plane, and its cell, at a place in CSS pixels.
  under(x: number, y: number): { point: Vec3; cell: Index3 } {
    const { frame, middle, pixel } = this.aim_with(1);
    const point = plus(plus(middle, frame.right, (x - this.width / 2) * pixel), frame.up, (this.height / 2 - y) * pixel);
    return { point, cell: for_axes((d) => this.viewer.axes[d].cell_at(point[d])) };
  }

  // The labels that the picture has there; null where it has none of this plane yet.
  labels_at(x: number, y: number): readonly number[] | null {
    const { picture } = this;
    if (!picture || this.told.waiting) return null;
    const scale = picture.aim.width / this.width;
    const number = picture.numbers[Math.floor(y * scale) * picture.aim.width + Math.floor(x * scale)];
    return number === undefined ? null : this.sets.members(number);
  }

  // Moves the picture by CSS pixels.
  pan(dx: number, dy: number): void {
    const { frame, middle, pixel } = this.aim_with(1);
    this.viewer.centre.value = [...plus(plus(middle, frame.right, -dx * pixel), frame.up, dy * pixel)];
  }

  // What is at a place, in CSS pixels, stays there.
  zoom_by(factor: number, x: number, y: number): void {
    const { frame, middle, pixel } = this.aim_with(1);
    const by = (1 - 1 / factor) * pixel;
    this.viewer.centre.value = [...plus(plus(middle, frame.right, (x - this.width / 2) * by), frame.up, (this.height / 2 - y) * by)];
    this.viewer.zoom.value = factor / pixel;
  }

  zoom_in_middle(factor: number): void {
    this.zoom_by(factor, this.width / 2, this.height / 2);
  }

  private moved(): void {
    this.at_rest = false;
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => {
      this.at_rest = true;
      this.invalidate();
    }, REST);
    this.invalidate();
  }

  private tell(state: PlaneState): void {
    const { waiting, damaged, trouble } = this.told;
    this.told = state;
    if (waiting !== state.waiting || damaged !== state.damaged || trouble !== state.trouble) this.says(state);
  }

  private invalidate(): void {
    this.request ||= requestAnimationFrame(() => {
      this.request = 0;
      this.draw();
    });
  }

  private aim_with(ratio: number): PlaneAim {
    const { viewer, width, height } = this;
    const frame = frame_in(viewer);
    const zoom = viewer.zoom.value || fitting_zoom(viewer.bounds, AXES.map((axis) => ({ axis, width, height })));
    return { frame, middle: onto(frame, viewer.centre.value), pixel: 1 / (zoom * ratio), width: Math.round(width * ratio), height: Math.round(height * ratio) };
  }

  private draw(): void {
    if (this.width < 8 || this.height < 8) return;
    const ratio = Math.min(devicePixelRatio, FINEST);
    const aim = this.aim_with(ratio);
    this.source.want(aim, this.at_rest);
    this.ink ??= read_ink(this.host);
    for (const canvas of [this.cells, this.lines])
      if (canvas.width !== aim.width || canvas.height !== aim.height) [canvas.width, canvas.height] = [aim.width, aim.height];
    this.paint();
    this.draw_picture(aim);
    if (!this.told.trouble) this.tell({ ...this.told, waiting: this.sharp_query !== plane_query(aim) });
    this.draw_lines(aim, ratio);
  }

  // Colours the picture.
  private paint(): void {
    const { picture, palette, ink } = this;
    if (!picture || !ink) return;
    palette.update(this.viewer.shown_looks.value, ink.ground, ink.outside);
    if (this.painted === palette.version) return;
    this.painted = palette.version;
    const { width, height } = picture.aim;
    const image = new ImageData(width, height);
    const out = new Uint32Array(image.data.buffer);
    const { numbers, damaged } = picture;
    const { colors } = palette;
    for (let i = 0; i < out.length; ++i) out[i] = colors[numbers[i]!]!;
    for (const { x0, y0, x1, y1 } of damaged)
      for (let y = y0; y < y1; ++y) for (let x = x0; x < x1; ++x) out[y * width + x] = ink.stripes[((x + y) & 15) < 3 ? 0 : 1];
    [this.picture_canvas.width, this.picture_canvas.height] = [width, height];
    this.picture_canvas.getContext("2d")!.putImageData(image, 0, 0);
  }

  // The picture that is there, where it belongs in what is to be seen.
  private draw_picture(aim: PlaneAim): void {
    const context = this.cells.getContext("2d", { alpha: false })!;
    context.fillStyle = `rgb(${this.ink!.outside.join(" ")})`;
    context.fillRect(0, 0, aim.width, aim.height);
    if (!this.picture) return;
    const { aim: of } = this.picture;
    const scale = of.pixel / aim.pixel;
    const off = plus(of.middle, aim.middle, -1);
    const x = aim.width / 2 + dot(aim.frame.right, off) / aim.pixel - (of.width * scale) / 2;
    const y = aim.height / 2 - dot(aim.frame.up, off) / aim.pixel - (of.height * scale) / 2;
    const exact = (n: number) => (Math.abs(n - Math.round(n)) < 1e-6 ? Math.round(n) : n);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.picture_canvas, exact(x), exact(y), exact(of.width * scale), exact(of.height * scale));
  }

  private draw_lines(aim: PlaneAim, ratio: number): void {
    const { viewer } = this;
    const ink = this.ink!;
    const c = this.lines.getContext("2d")!;
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, aim.width, aim.height);
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.font = FONT;
    const { frame, middle } = aim;
    const zoom = 1 / (aim.pixel * ratio);
    const place = (p: Vec3): [number, number] => {
      const off = plus(p, middle, -1);
      return [this.width / 2 + dot(frame.right, off) * zoom, this.height / 2 - dot(frame.up, off) * zoom];
    };
    const path = (points: readonly (readonly [number, number])[], color: string, width: number, close = false) => {
      c.beginPath();
      points.forEach(([x, y], i) => (i ? c.lineTo(x, y) : c.moveTo(x, y)));
      if (close) c.closePath();
      for (const [style, more] of [[ink.halo, 2], [color, 0]] as const) {
        c.strokeStyle = style;
        c.lineWidth = width + more;
        c.stroke();
      }
    };
    const outline = outline_of(frame, viewer.axes).map(place);
    if (outline.length > 2) path(outline, ink.border, 1, true);
    if (viewer.show_axes.value) {
      // Where the other slices cut, in their colours.
      const [x, y] = place(frame.through);
      const far = this.width + this.height;
      for (const d of AXES) {
        const along = cross(frame.normal, for_axes((e) => (e === d ? 1 : 0)));
        const length = Math.hypot(...along);
        if (length < 1e-6) continue; // it is this plane
        const [dx, dy] = [(dot(frame.right, along) / length) * far, (-dot(frame.up, along) / length) * far];
        for (const side of [-1, 1]) path([[x + (side * dx * 7) / far, y + (side * dy * 7) / far], [x + side * dx, y + side * dy]], ink.axes[d], 1.5);
      }
    }
    const pinned = viewer.pinned.value;
    if (pinned) {
      const [x, y] = place(viewer.centre_of(pinned));
      c.beginPath();
      c.arc(x, y, 5, 0, 2 * Math.PI);
      c.lineWidth = 2;
      c.strokeStyle = ink.accent;
      c.stroke();
    }
    if (viewer.show_scale.value) {
      const length = round_length(Math.min(BAR, this.width / 3) / zoom);
      const [right, y, width] = [this.width - 14, this.height - 30, length * zoom];
      c.fillStyle = ink.halo;
      c.fillRect(right - width - 2, y - 5, width + 4, 8);
      c.fillStyle = ink.text;
      c.fillRect(right - width, y - 3, width, 4);
      c.textAlign = "center";
      c.textBaseline = "bottom";
      c.strokeStyle = ink.halo;
      c.lineWidth = 3;
      c.strokeText(length_text(length, viewer.info.units), right - width / 2, y - 8);
      c.fillText(length_text(length, viewer.info.units), right - width / 2, y - 8);
    }
  }
}
