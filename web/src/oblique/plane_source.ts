// Asks the server for the cells that a plane meets: a coarse picture at once, one at a time, while the plane moves; the sharp one part by part when it
// rests. What is not wanted any more is called off.
import type { GridAddress } from "../base/grid";
import { type Part, parts_of } from "../base/picture_parts";
import { ServerError, get } from "../server/api";
import { OUTSIDE, type SetTable, UNKNOWN } from "../tiles/sets";
import { decode_sets } from "../tiles/tile";
import { type PlaneFrame, dot } from "./frame";

const PART = 512; // pixels along a side of what is asked for at once
const AT_ONCE = 2; // requests: browsers open six connections
const COARSE_TIME = 70; // milliseconds that a coarse picture may take to come

export interface PlaneAim {
  readonly frame: PlaneFrame;
  readonly middle: readonly [number, number, number]; // the point in the middle of the picture
  readonly pixel: number; // its side, as a length
  readonly width: number; // pixels
  readonly height: number;
}

// Rows from the top.
export interface PlanePicture {
  readonly aim: PlaneAim;
  readonly numbers: Uint32Array; // of sets, for each pixel
  readonly damaged: readonly Part[]; // parts that can't be read
}

export interface PlaneEvents {
  shows(picture: PlanePicture, sharp: boolean): void;
  failed(error: unknown): void;
}

export function plane_query({ frame, middle, pixel, width, height }: PlaneAim): string {
  return `plane=${[...frame.normal, dot(frame.normal, frame.through)].join(",")}&centre=${middle.join(",")}&pixel=${pixel}&size=${width},${height}`;
}

const is_damage = (error: unknown): boolean => error instanceof ServerError && error.status === 500;

export class PlaneSource {
  private readonly closing = new AbortController();
  private coarse_key = ""; // of the newest coarse picture
  private sharp_key = ""; // of the sharp picture that is there or comes
  private coarse_runs = false;
  private factor = 4; // pixels of the screen along a side of a coarse pixel
  private sharp: AbortController | null = null;
  private aim: PlaneAim | null = null;

  constructor(
    private readonly address: GridAddress,
    private readonly sets: SetTable,
    private readonly events: PlaneEvents,
  ) {}

  want(aim: PlaneAim, at_rest: boolean): void {
    this.aim = aim;
    const key = plane_query(aim);
    if (this.sharp && key !== this.sharp_key) this.call_off();
    if (at_rest && key !== this.sharp_key) void this.ask_sharp(aim, key);
    else if (!at_rest && key !== this.coarse_key && key !== this.sharp_key) void this.ask_coarse(aim, key);
  }

  // Asks again for what is missing.
  again(): void {
    this.call_off();
    this.coarse_key = this.sharp_key = "";
    if (this.aim) this.want(this.aim, true);
  }

  close(): void {
    this.closing.abort();
    this.call_off();
  }

  private call_off(): void {
    this.sharp?.abort();
    this.sharp = null;
    this.sharp_key = "";
  }

  private async fetch_part(aim: PlaneAim, part: Part, numbers: Uint32Array, signal: AbortSignal): Promise<void> {
    const [width, height] = [part.x1 - part.x0, part.y1 - part.y0];
    const query = `${plane_query(aim)}&window=${part.x0},${part.y0},${part.x1},${part.y1}`;
    const buffer = await (await get(this.address.plane(query), { signal, priority: "high" })).arrayBuffer();
    const { sets: found, labels } = decode_sets(`a plane at ${part.x0}, ${part.y0}`, [width, height], buffer, this.sets);
    const sets = found.map((set) => (this.sets.members(set)?.length === 0 ? OUTSIDE : set)); // the server's has no members
    for (let row = 0; row < height; ++row) {
      const to = (part.y1 - 1 - row) * aim.width + part.x0; // the lowest row comes first
      for (let x = 0; x < width; ++x) numbers[to + x] = sets[labels ? labels[row * width + x]! : 0]!;
    }
  }

  private async ask_coarse(aim: PlaneAim, key: string): Promise<void> {
    if (this.coarse_runs) return;
    this.coarse_runs = true;
    const [width, height] = [aim.width, aim.height].map((n) => Math.max(1, Math.ceil(n / this.factor))) as [number, number];
    const coarse = { ...aim, width, height, pixel: aim.pixel * this.factor };
    const numbers = new Uint32Array(width * height).fill(UNKNOWN);
    const began = performance.now();
    try {
      await this.fetch_part(coarse, { x0: 0, y0: 0, x1: width, y1: height }, numbers, this.closing.signal);
      const faster = Math.min(Math.max((performance.now() - began) / COARSE_TIME, 0.5), 2);
      this.factor = Math.min(Math.max(this.factor * Math.sqrt(faster), 2), 12);
      if (this.sharp_key !== plane_query(this.aim!)) this.events.shows({ aim: coarse, numbers, damaged: [] }, false);
    } catch {
      // The sharp picture will say what is wrong.
    }
    this.coarse_runs = false;
    this.coarse_key = key;
  }

  private async ask_sharp(aim: PlaneAim, key: string): Promise<void> {
    this.call_off();
    const abort = (this.sharp = new AbortController());
    this.sharp_key = key;
    const numbers = new Uint32Array(aim.width * aim.height).fill(UNKNOWN);
    const damaged: Part[] = [];
    const waiting = parts_of(aim.width, aim.height, PART);
    const take = async () => {
      for (let part = waiting.shift(); part; part = waiting.shift()) {
        try {
          await this.fetch_part(aim, part, numbers, abort.signal);
        } catch (error) {
          if (!is_damage(error)) throw error;
          damaged.push(part);
        }
        if (!abort.signal.aborted && waiting.length > 0) this.events.shows({ aim, numbers, damaged }, false);
      }
    };
    try {
      await Promise.all(Array.from({ length: AT_ONCE }, take));
      if (abort.signal.aborted) return;
      this.sharp = null;
      this.events.shows({ aim, numbers, damaged }, true);
    } catch (error) {
      if (abort.signal.aborted) return;
      abort.abort();
      this.sharp = null; // the key stays: what failed is asked for again by again()
      this.events.failed(error);
    }
  }
}
