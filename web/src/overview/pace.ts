// When the overview draws. What the user does in it is drawn with the next frame. What happens elsewhere (slices swept by wheel, looks)
// waits until the page has a quiet moment, and the more a frame costs the rarer it gets: never more than about a tenth of the time, and
// at most ten times a second. Nothing runs while nothing changes.
export interface Pace {
  soon(): void;
  later(): void;
  // What a frame has cost, in milliseconds.
  cost(ms: number): void;
  stop(): void;
}

const QUIET = 80; // ms without a change
const SHARE = 10; // a frame of 20 ms at most every 200 ms

export function make_pace(draw: (calm: boolean) => void): Pace {
  let frame = 0;
  let idle = 0;
  let timer = 0;
  let last = -Infinity; // end of the last drawing
  let first_change = 0; // that waits
  let price = 8;
  const idle_callback = window.requestIdleCallback ?? ((call: () => void) => window.setTimeout(call, 16));
  const cancel_idle = window.cancelIdleCallback ?? window.clearTimeout;

  const cancel = () => {
    cancelAnimationFrame(frame);
    clearTimeout(timer);
    cancel_idle(idle);
    frame = timer = idle = 0;
  };
  const now = (calm: boolean) => {
    cancel();
    first_change = 0;
    draw(calm);
    last = performance.now();
  };
  return {
    soon() {
      if (!frame) frame = requestAnimationFrame(() => now(false));
    },
    later() {
      if (frame) return;
      const time = performance.now();
      if (!first_change) first_change = time;
      const rarest = Math.max(100, SHARE * price);
      // A quiet moment, but a sweep that never pauses is followed too.
      const due = Math.max(Math.min(time + QUIET, first_change + rarest), last + rarest);
      clearTimeout(timer);
      cancel_idle(idle);
      timer = window.setTimeout(() => {
        idle = idle_callback(() => now(true), { timeout: 300 });
      }, due - time);
    },
    cost(ms) {
      price = ms;
    },
    stop: cancel,
  };
}
