// How sharply the next frame is drawn. What moves is drawn quickly; sharper pictures follow when nothing moves any more.
import type { Pace } from "./pace";
import type { Ladder, Rest } from "./quality";

const SETTLE = 160; // milliseconds after the last movement until a sharper picture
const SHARPEST = 800; // and from then until the sharpest, which may take long on a slow machine
const SETTLE_FAR = 1300; // until the sharpest when something else on the page moved: it must not wait for the overview

export class Settling {
  rest: Rest = 2;
  private timer = 0;

  constructor(
    private readonly ladder: Ladder,
    private readonly pace: Pace,
  ) {}

  // Something moved in the overview itself: it is drawn with the next frame.
  moved(): void {
    this.rest = 0;
    this.sharpen(1, SETTLE, () => this.sharpen(2, SHARPEST));
    this.pace.soon();
  }

  // Something changed elsewhere on the page: it is drawn in a quiet moment.
  followed(): void {
    this.rest = 0;
    this.sharpen(2, SETTLE_FAR);
    this.pace.later();
  }

  stop(): void {
    clearTimeout(this.timer);
  }

  private sharpen(to: Rest, after: number, then?: () => void): void {
    clearTimeout(this.timer);
    if (this.ladder.quality(this.rest) === this.ladder.quality(2)) return;
    this.timer = window.setTimeout(() => {
      this.rest = to;
      if (to === 2) this.pace.later();
      else this.pace.soon();
      then?.();
    }, after);
  }
}
