// How sharp a frame may be so that moving stays smooth: two pixels a CSS pixel where the machine has the time (that smooths edges, too),
// fewer while something moves on a slow one, and at last the coarser bodies. Found by measuring, since nothing else tells. Pure.
import type { Quality } from "./stage";

export interface Ladder {
  still(): Quality;
  moving(): Quality;
  measured(quality: Quality, ms: number): void;
  // Whether a measured frame would tell something new.
  curious(): boolean;
  // Other bodies or another size: what was measured says little.
  changed(): void;
}

const BUDGET = 26; // ms a frame while moving
const STILL_BUDGET = 90; // a single frame at rest

export function make_ladder(screen_ratio = globalThis.devicePixelRatio || 1): Ladder {
  const best = Math.min(Math.max(screen_ratio, 2), 3);
  const steps: readonly Quality[] = [
    { ratio: best, coarse: false },
    { ratio: best / 2, coarse: false },
    { ratio: best / 2, coarse: true },
    { ratio: best / 3, coarse: true },
  ];
  let at = 1;
  let still = 0;
  let samples = 0;
  let too_slow = -1; // the best step that was too slow
  return {
    still: () => steps[still]!,
    moving: () => steps[at]!,
    measured(quality, ms) {
      const step = steps.indexOf(quality);
      ++samples;
      if (samples <= 1) return; // the first one also compiles and uploads
      if (step === still && ms > STILL_BUDGET && still === 0) still = 1;
      if (step !== at) return;
      if (ms > BUDGET && at + 1 < steps.length) {
        too_slow = at;
        ++at;
      } else if (ms < BUDGET / 4 && at - 1 > too_slow) --at;
    },
    curious: () => samples < 3,
    changed() {
      samples = 0;
      too_slow = -1;
      still = 0;
    },
  };
}
