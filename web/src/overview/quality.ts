// How sharp a frame may be, so that movement stays smooth and the other views are not held up. A machine that has the
// time draws two pixels per CSS pixel, which smooths edges as well. A slow one draws fewer while something moves, and
// coarser bodies, because rendering in software pays per triangle. This is found out by measuring: nothing else tells
// how fast a machine is. Pure.
export interface Quality {
  readonly ratio: number; // pixels per CSS pixel
  readonly coarser: number; // by how many levels the bodies are coarser than the finest there is
}

// The state of what is drawn: 0 while it moves, 1 when it has come to rest, 2 when nothing has happened for longer.
export type Rest = 0 | 1 | 2;

export interface Ladder {
  quality(rest: Rest): Quality;
  measured(quality: Quality, ms: number): void;
  // Whether measuring a frame would tell something new.
  curious(): boolean;
  // The bodies or the size have changed, so what was measured before says little.
  changed(): void;
}

const BUDGETS = [30, 110, 350] as const; // milliseconds per frame, by its Rest
const KEPT = 5; // frames, whose median counts: other programs make single frames slow
const RETRY = 90; // frames after which a quality that was too slow is tried again

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

  const price = (step: number) => [...times[step]!].sort((a, b) => a - b)[times[step]!.length >> 1]; // undefined: not measured
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
      if (++frames === 1) return; // the first frame also compiles and uploads
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
