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

const BUDGETS = [30, 110, 350] as const; // ms a frame, by its Rest
const KEPT = 5; // frames, of which the middle one counts: other programs make single ones slow
const RETRY = 90; // frames until what was too slow may be tried again

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
  let at: [number, number, number] = [3, 1, 0];
  let times: number[][] = steps.map(() => []);
  let frames = 0;

  const price = (step: number) => [...times[step]!].sort((a, b) => a - b)[times[step]!.length >> 1]; // undefined: not known
  const choose = (rest: Rest) => {
    const step = at[rest];
    const now = price(step);
    if (now === undefined || (times[step]!.length < 3 && now < 4 * BUDGETS[rest])) return;
    if (now > BUDGETS[rest] && step + 1 < steps.length) at[rest] = step + 1;
    else if (now < BUDGETS[rest] / 3 && step > 0 && (price(step - 1) ?? 0) <= BUDGETS[rest]) at[rest] = step - 1;
  };
  return {
    quality: (rest) => steps[at[rest]]!,
    measured(quality, ms) {
      if (++frames === 1) return; // it also compiles and uploads
      const step = steps.indexOf(quality);
      times[step] = [...times[step]!.slice(1 - KEPT), ms];
      for (const rest of [0, 1, 2] as const) choose(rest);
      if (frames % RETRY === 0) times = times.map((list, i) => (i === step ? list : []));
    },
    curious: () => frames < 4,
    changed() {
      times = steps.map(() => []);
      frames = 0;
      at = [3, 1, 0];
    },
  };
}
