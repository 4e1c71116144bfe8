// What differs between two pictures of the same place: each sample is compared, so at the level in view no cell of the finer
// grid is passed over. Materials are compared by their names, as `teracell diff` does. Free of the document.
//
// A coarse cell is known by the set of its materials alone. Where two sets have no name in common, all of its cells differ; where
// one of them is nothing but the background, something was added or removed.
// Where the sets are unequal, some may. Where they are equal and have several names, nothing is known: only cells of
// level 0 are compared exactly.
import type { Region } from "../../tiles/regions";
import { OUTSIDE, type SetTable, UNKNOWN } from "../../tiles/sets";
import type { SampleCells } from "./camera";
import { NumberRows } from "./paint";

// Greater ones prevail in a pixel that has samples of several kinds.
export const SAME = 0; // or not known
export const ALONE = 1; // in one of the grids only
export const PARTLY = 2; // the sets are unequal, but have names in common
export const DIFFERS = 3; // other materials
export const REMOVED = 4; // only the background is left
export const ADDED = 5; // there was nothing but the background
export type Verdict = typeof SAME | typeof ALONE | typeof PARTLY | typeof DIFFERS | typeof REMOVED | typeof ADDED;

// A grid: the names of its labels' materials, that of its background, and the numbers of its sets.
export interface Side {
  readonly names: readonly string[];
  readonly background: string;
  readonly sets: SetTable;
}

const MOST_KEPT = 1 << 16; // pairs

// Compares sets of two grids by the names of their materials. What was found is kept, mostly of few pairs.
export class SetComparison {
  private readonly found = new Map<number, Verdict>();

  constructor(
    private readonly left: Side,
    private readonly right: Side,
  ) {}

  verdict(a: number, b: number): Verdict {
    const pair = a * 2 ** 26 + b;
    let verdict = this.found.get(pair);
    if (verdict === undefined) {
      if (this.found.size === MOST_KEPT) this.found.clear();
      this.found.set(pair, (verdict = this.compare(a, b)));
    }
    return verdict;
  }

  private compare(a: number, b: number): Verdict {
    if (a === UNKNOWN || b === UNKNOWN) return SAME;
    if (a === OUTSIDE || b === OUTSIDE) return a === b ? SAME : ALONE;
    const names = (side: Side, set: number) => new Set(side.sets.members(set)!.map((label) => side.names[label]));
    const [x, y] = [names(this.left, a), names(this.right, b)];
    if (x.size === 0 || y.size === 0) return SAME; // it can't be read
    const common = [...x].filter((name) => y.has(name)).length;
    const is_background = (of: ReadonlySet<string | undefined>, side: Side) => of.size === 1 && of.has(side.background);
    if (common === 0) return is_background(x, this.left) ? ADDED : is_background(y, this.right) ? REMOVED : DIFFERS;
    return common === x.size && common === y.size ? SAME : PARTLY;
  }
}

export interface Drawn {
  readonly samples: SampleCells;
  readonly regions: readonly Region[];
}

// The verdict for each pixel, row by row from the top: the greatest of its samples'. REQUIRES: as many samples in both.
export function compare_pictures(a: Drawn, b: Drawn, comparison: SetComparison): Uint8Array {
  const { each, columns, rows } = a.samples;
  const width = columns.length / each;
  const out = new Uint8Array((width * rows.length) / each);
  const [left, right] = [new NumberRows(a.samples, a.regions), new NumberRows(b.samples, b.regions)];
  const line = new Uint8Array(width); // of the last row of samples
  for (let y = 0; y < rows.length; ++y) {
    if (!left.repeats(y) || !right.repeats(y)) fill(line, left.row(y), right.row(y), each, comparison);
    const at = Math.floor(y / each) * width;
    if (y % each === 0) out.set(line, at);
    else for (let x = 0; x < width; ++x) if (line[x]! > out[at + x]!) out[at + x] = line[x]!;
  }
  return out;
}

function fill(line: Uint8Array, a: Uint32Array, b: Uint32Array, each: 1 | 2, comparison: SetComparison): void {
  line.fill(SAME);
  const shift = each - 1;
  let last_a = -1;
  let last_b = -1;
  let verdict: number = SAME;
  for (let i = 0; i < a.length; ++i) {
    const here_a = a[i]!;
    const here_b = b[i]!;
    if (here_a !== last_a || here_b !== last_b) {
      last_a = here_a;
      last_b = here_b;
      verdict = comparison.verdict(here_a, here_b);
    }
    if (verdict > line[i >> shift]!) line[i >> shift] = verdict;
  }
}
