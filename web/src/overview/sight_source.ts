// Asks for what is seen of a subject, and colours it. A quick picture of few pixels comes first, and again while something
// moves, one at a time. Once everything rests, the sharp picture follows, part by part from the middle outwards. What is
// not wanted any more is called off.
import { type Part, parts_of } from "../base/picture_parts";
import { get } from "../server/api";
import { type Frame, empty_frame, put_part } from "./frame";
import type { Sights } from "./sight/sights";
import { PART } from "./sight/query";
import type { Sighting, SightSubject } from "./sight/subject";

const QUICK_TIME = 90; // milliseconds that a quick picture may take to come
const FEWEST_QUICK = 40_000; // pixels
const MOST_QUICK = 240_000;
const MOST_PIXELS = 2_600_000; // of a sharp picture
const AT_ONCE = 2; // requests: browsers open six connections, and the slices come first

// What is to be seen.
export interface Aim extends Sighting {
  readonly points: number; // that can be drawn while something moves
}

export interface SightEvents {
  quick(frame: Frame): void;
  sharp(frame: Frame, done: boolean): void; // also when a part of the same frame has come
  failed(error: unknown): void;
}

export class SightSource {
  private aim: Aim | null = null;
  private quick_key = ""; // of the newest quick picture
  private sharp_key = ""; // of the sharp picture that is there or comes
  private quick_runs = false;
  private at_rest = true;
  private quick_pixels = 80_000;
  private sharp_abort: AbortController | null = null;
  private kept: { quick: { frame: Frame; layers: readonly Sights[] } | null; sharp: { frame: Frame; parts: { at: Part; layers: readonly Sights[] }[]; whole: boolean } | null } = {
    quick: null,
    sharp: null,
  };

  constructor(
    private readonly subject: SightSubject,
    private readonly signal: AbortSignal,
    private readonly events: SightEvents,
  ) {}

  // The size of a sharp picture in a panel.
  static size(width: number, height: number): [number, number] {
    const ratio = Math.min(globalThis.devicePixelRatio || 1, 2, Math.sqrt(MOST_PIXELS / (width * height)));
    return [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
  }

  want(aim: Aim, at_rest: boolean): void {
    this.aim = aim;
    this.at_rest = at_rest;
    const key = this.key_of(aim);
    if (this.sharp_abort && (!at_rest || key !== this.sharp_key)) this.call_off();
    if (key !== this.quick_key) void this.ask_quick();
    else if (at_rest && key !== this.sharp_key) void this.ask_sharp();
  }

  // Colours have changed.
  recolor(): void {
    const { subject } = this;
    const { quick, sharp } = this.kept;
    if (quick) this.events.quick((quick.frame = { ...quick.frame, ...subject.color(quick.layers) }));
    if (!sharp) return;
    for (const { at, layers } of sharp.parts) put_part(sharp.frame, subject.color(layers), at.x0, at.y0);
    this.events.sharp(sharp.frame, sharp.whole);
  }

  // Asks again for what is missing.
  again(): void {
    this.call_off();
    this.quick_key = this.sharp_key = "";
    if (this.aim) this.want(this.aim, true);
  }

  private key_of({ orbit, cuts, width, height }: Aim): string {
    return JSON.stringify([orbit, cuts, this.subject.key(), SightSource.size(width, height), width / height]);
  }

  private fetch(from: Sighting, more: string, signal: AbortSignal): Promise<readonly Sights[]> {
    return this.subject.fetch(from, more, (address) => get(address, { signal, priority: "low" }));
  }

  private async ask_quick(): Promise<void> {
    if (this.quick_runs || !this.aim) return;
    this.quick_runs = true;
    const { aim } = this;
    const key = this.key_of(aim);
    const began = performance.now();
    const scale = Math.min(1, Math.sqrt(Math.min(this.quick_pixels, aim.points) / (aim.width * aim.height)));
    const [width, height] = [Math.max(1, Math.round(aim.width * scale)), Math.max(1, Math.round(aim.height * scale))];
    let frame: Frame | null = null;
    try {
      const layers = await this.fetch({ ...aim, width, height }, "&quick=1", this.signal);
      frame = { ...this.subject.color(layers), orbit: aim.orbit };
      this.kept.quick = { frame, layers };
      const faster = Math.min(Math.max(QUICK_TIME / (performance.now() - began), 0.5), 1.5);
      this.quick_pixels = Math.min(Math.max(this.quick_pixels * faster, FEWEST_QUICK), MOST_QUICK);
    } catch (error) {
      if (!this.signal.aborted) this.events.failed(error);
    }
    this.quick_runs = false;
    this.quick_key = key; // also after an error, which is not to be repeated for ever
    if (!frame) return;
    this.want(this.aim, this.at_rest); // what comes next is on its way while this is drawn
    this.events.quick(frame);
  }

  private call_off(): void {
    this.sharp_abort?.abort();
    this.sharp_abort = null;
    this.sharp_key = "";
    this.kept.sharp = null;
  }

  private async ask_sharp(): Promise<void> {
    this.call_off();
    const aim = this.aim!;
    const abort = (this.sharp_abort = new AbortController());
    const stop = () => abort.abort();
    this.signal.addEventListener("abort", stop, { once: true });
    this.sharp_key = this.key_of(aim);
    const [width, height] = SightSource.size(aim.width, aim.height);
    const sharp: NonNullable<typeof this.kept.sharp> = { frame: empty_frame(aim.orbit, width, height), parts: [], whole: false };
    this.kept.sharp = sharp;
    const waiting = parts_of(width, height, PART);
    const take = async () => {
      for (let part = waiting.shift(); part; part = waiting.shift()) {
        const layers = await this.fetch({ ...aim, width, height }, `&window=${part.x0},${part.y0},${part.x1},${part.y1}`, abort.signal);
        put_part(sharp.frame, this.subject.color(layers), part.x0, part.y0);
        sharp.parts.push({ at: part, layers });
        if (waiting.length > 0) this.events.sharp(sharp.frame, false);
      }
    };
    try {
      await Promise.all(Array.from({ length: AT_ONCE }, take));
      sharp.whole = true;
      this.sharp_abort = null;
      this.events.sharp(sharp.frame, true);
    } catch (error) {
      if (abort.signal.aborted) return;
      abort.abort();
      this.sharp_abort = null; // the key stays: what failed is asked for again by again()
      this.events.failed(error);
    } finally {
      this.signal.removeEventListener("abort", stop);
    }
  }
}
