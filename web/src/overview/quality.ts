// How sharp a frame may be while something moves, so that movement stays smooth and the other views are not held up. A
// slow machine draws fewer pixels, and fewer points. This is found out by measuring: nothing else tells how fast a
// machine is. Pure.
export interface Quality {
  readonly ratio: number; // pixels per CSS pixel
  readonly points: number; // at most
}

const BUDGET = 30; // milliseconds per frame
const KEPT = 5; // frames, whose median counts: other programs make single frames slow
const RETRY = 90; // frames after which a quality that was too slow is tried again
const START = 2;

export function make_ladder(screen_ratio = globalThis.devicePixelRatio || 1) {
  const best = Math.min(Math.max(screen_ratio, 1), 3);
  const steps: readonly Quality[] = [
    { ratio: best, points: 2_000_000 },
    { ratio: best, points: 500_000 },
    { ratio: best, points: 120_000 },
    { ratio: best / 1.5, points: 80_000 },
    { ratio: best / 2, points: 40_000 },
    { ratio: best / 3, points: 20_000 },
  ];
  let at = START;
  let times: number[][] = steps.map(() => []);
  let frames = 0;

  const price = (step: number) => [...times[step]!].sort((a, b) => a - b)[times[step]!.length >> 1]; // undefined: not measured
  const choose = () => {
    const now = price(at);
    if (now === undefined || (times[at]!.length < 3 && now < 4 * BUDGET)) return;
    if (now > BUDGET && at + 1 < steps.length) ++at;
    else if (now < BUDGET / 3 && at > 0 && (price(at - 1) ?? 0) <= BUDGET) --at;
  };
  return {
    quality: () => steps[at]!,
    measured(quality: Quality, ms: number) {
      if (++frames === 1) return; // the first frame also compiles and uploads
      const step = steps.indexOf(quality);
      if (step < 0) return;
      times[step] = [...times[step]!.slice(1 - KEPT), ms];
      choose();
      if (frames % RETRY === 0) times = times.map((list, i) => (i === step ? list : []));
    },
    // The size has changed, so what was measured before says little.
    changed() {
      times = steps.map(() => []);
      frames = 0;
      at = START;
    },
  };
}
