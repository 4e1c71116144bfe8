// A number for each set of labels that occurs in tiles. The numbers are the same in all tiles of a grid, so that
// neighbours can be compared and one palette colours all tiles. The first two numbers stand for no set.
import { type LabelLook, color_of_shares, shown_color } from "../base/materials";

export const OUTSIDE = 0; // outside the grid
export const UNKNOWN = 1; // in the grid, where no tile has come yet
const FIRST = 2;
const SHARES = 16; // parts of a mixed cell

export class SetTable {
  private readonly numbers = new Map<string, number>();
  private readonly sets: (readonly number[])[] = [[], []];

  // `whole`: of which label a label is a part.
  constructor(private readonly whole: (label: number) => number = (label) => label) {}

  get size(): number {
    return this.sets.length;
  }

  number_of(set: readonly number[]): number {
    const name = set.join(",");
    let number = this.numbers.get(name);
    if (number === undefined) {
      number = this.sets.length;
      this.numbers.set(name, number);
      this.sets.push(set);
    }
    return number;
  }

  // Labels in ascending order; null for a number that stands for no set.
  members(number: number): readonly number[] | null {
    const parts = this.parts(number);
    return parts && this.is_shared_out(parts) ? [...new Set(parts)].sort((a, b) => a - b) : parts;
  }

  // As RGBA, not premultiplied. REQUIRES: the number stands for a set.
  color(number: number, looks: readonly LabelLook[]): [number, number, number, number] {
    const parts = this.parts(number)!;
    return this.is_shared_out(parts) ? color_of_shares(parts, looks) : shown_color(parts, looks);
  }

  // The number of the set that a cell has without its shares, of whole labels.
  owner(number: number): number {
    const parts = this.parts(number);
    if (!parts) return number;
    const own = this.is_shared_out(parts) ? parts.slice(0, 1) : parts;
    const wholes = own.map(this.whole).filter((label, n, all) => label !== all[n - 1]);
    return own === parts && wholes.every((label, n) => label === own[n]) && wholes.length === own.length ? number : this.number_of(wholes);
  }

  // The same as members(), but each label of a mixed cell as often as its share of the cell says, the cell's own label first.
  private parts(number: number): readonly number[] | null {
    return number < FIRST ? null : this.sets[number]!;
  }

  // A set ascends.
  private is_shared_out(parts: readonly number[]): boolean {
    return parts.length === SHARES && parts.some((label, i) => i > 0 && label <= parts[i - 1]!);
  }
}

export type Rgb = readonly [number, number, number];

// A colour as one number, in the order in which a little-endian machine writes its bytes into a picture.
export const packed = ([r, g, b]: Rgb): number => (0xff000000 | (b << 16) | (g << 8) | r) >>> 0;

// The opaque colours of all sets, laid over the colour of the grid's ground. They are kept between frames: only new
// sets are computed, unless the looks or the theme have changed. Then all of them are, and `version` counts up.
export class Palette {
  colors = new Uint32Array(256);
  version = 0;
  private known = 0;
  private looks: readonly LabelLook[] = [];
  private ground: Rgb = [255, 255, 255];
  private outside: Rgb = [255, 255, 255];

  constructor(private readonly sets: SetTable) {}

  update(looks: readonly LabelLook[], ground: Rgb, outside: Rgb): void {
    if (looks !== this.looks || packed(ground) !== packed(this.ground) || packed(outside) !== packed(this.outside)) {
      this.looks = looks;
      this.ground = ground;
      this.outside = outside;
      this.known = 0;
      ++this.version;
    }
    if (this.colors.length < this.sets.size) {
      const larger = new Uint32Array(2 * this.sets.size);
      larger.set(this.colors);
      this.colors = larger;
    }
    for (; this.known < this.sets.size; ++this.known) this.colors[this.known] = packed(this.color(this.known));
  }

  private color(number: number): Rgb {
    if (!this.sets.members(number)) return number === OUTSIDE ? this.outside : this.ground;
    const [r, g, b, alpha] = this.sets.color(number, this.looks);
    const a = alpha / 255;
    const over = (c: number, under: number) => Math.round(c * a + under * (1 - a));
    return [over(r, this.ground[0]), over(g, this.ground[1]), over(b, this.ground[2])];
  }
}
