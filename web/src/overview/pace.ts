// When the overview draws. What people do in the overview is drawn with the next frame. What happens elsewhere on the
// page (another slice, another colour) waits for a quiet moment. The more such a frame costs, the rarer it is: together
// they take at most about a tenth of the time, and there are at most ten per second. Nothing runs while nothing
// changes.
const QUIET = 80; // milliseconds without a change
const SHARE = 10; // a frame that takes 20 ms is drawn at most every 200 ms

export function make_pace(draw: (calm: boolean) => void) {
  let frame = 0;
  let idle = 0;
  let timer = 0;
  let last = -Infinity; // when the last drawing ended
  let first_change = 0; // when the first change happened that is not drawn yet
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
    // Draws with the next frame.
    soon() {
      if (!frame) frame = requestAnimationFrame(() => now(false));
    },
    // Draws in a quiet moment.
    later() {
      if (frame) return;
      const time = performance.now();
      if (!first_change) first_change = time;
      const rarest = Math.max(100, SHARE * price);
      // It waits for a quiet moment, but follows a sweep that never pauses as well.
      const due = Math.max(Math.min(time + QUIET, first_change + rarest), last + rarest);
      clearTimeout(timer);
      cancel_idle(idle);
      timer = window.setTimeout(() => {
        idle = idle_callback(() => now(true), { timeout: 300 });
      }, due - time);
    },
    // What a frame has cost, in milliseconds.
    cost(ms: number) {
      price = ms;
    },
    stop: cancel,
  };
}
