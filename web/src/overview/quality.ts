// How sharp a frame may be so that moving stays smooth and the other views aren't held up: two pixels a CSS pixel where the machine has
// the time (that smooths edges, too), fewer while something moves on a slow one, and coarser bodies there. Found by measuring, since
// nothing else tells; software rendering pays by the triangle. Pure.
export interface Quality {
  readonly ratio: number; // pixels a CSS pixel
  readonly coarser: number; // by how many levels the bodies are coarser than the finest there is
}

// Of what is drawn: while it moves, when it has come to rest, and when nothing has happened for longer.
export type Rest = 0 | 1 | 2;

export interface Ladder {
  quality(rest: Rest): Quality;
  measured(quality: Quality, ms: number): void;
  // Whether a measured frame would tell something new.
  curious(): boolean;
  // Other bodies or another size: what was measured says little.
  changed(): void;
}

const BUDGETS: readonly [number, number] = [30, 110]; // ms a frame, moving and at rest

export function make_ladder(screen_ratio = globalThis.devicePixelRatio || 1): Ladder {
  const best = Math.min(Math.max(screen_ratio, 2), 3);
  const steps: readonly Quality[] = [
    { ratio: best, coarser: 0 },
    { ratio: best, coarser: 1 },
    { ratio: best / 2, coarser: 0 },
    { ratio: best / 2, coarser: 1 },
    { ratio: best / 2, coarser: 2 },
    { ratio: best / 3, coarser: 2 },
  ];
  let at: [number, number] = [3, 1];
  let price: number[] = []; // of each step, where known
  let samples = 0;

  // The best step that is known to be, or may be, cheap enough; never more than one better than a known one.
  const choose = (rest: 0 | 1) => {
    const budget = BUDGETS[rest];
    let step = at[rest];
    if (price[step] === undefined) return;
    if (price[step]! > budget) {
      while (step + 1 < steps.length && (price[step] ?? 0) > budget) ++step;
    } else if (step > 0 && price[step]! < budget / 4 && (price[step - 1] ?? 0) <= budget) --step;
    at[rest] = step;
  };
  return {
    quality: (rest) => steps[rest === 2 ? 0 : at[rest]]!,
    measured(quality, ms) {
      ++samples;
      if (samples === 1) return; // it also compiles and uploads
      const step = steps.indexOf(quality);
      price[step] = price[step] === undefined ? ms : 0.6 * price[step]! + 0.4 * ms;
      choose(0);
      choose(1);
    },
    curious: () => samples < 4,
    changed() {
      price = [];
      samples = 0;
      at = [3, 1];
    },
  };
}
