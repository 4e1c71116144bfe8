// Says what is under the pointer: body, material and cell. What the picture knows is said at once; the cell is asked for
// when the pointer rests.
import type { Index3 } from "../base/grid";
import { element } from "./dom";

const REST = 120; // milliseconds

// What the server answers about a point of a picture.
export interface Seen {
  readonly at: readonly [number, number, number];
  readonly cell: Index3;
  readonly label: number;
  readonly material: number;
  readonly body: string | null;
}

export class Hover {
  readonly root = element("div", { class: "overview-tip", "aria-hidden": "true" });
  private timer = 0;
  private abort: AbortController | null = null;

  constructor(
    private readonly name_of: (label: number) => string,
    private readonly ask: (x: number, y: number, signal: AbortSignal) => Promise<Seen | null>,
    private readonly tell: (seen: Seen | null) => void,
  ) {
    this.root.hidden = true;
  }

  // `label`: null where nothing is seen.
  show(x: number, y: number, label: number | null, width: number): void {
    this.hide();
    if (label === null) return;
    this.root.hidden = false;
    this.root.textContent = this.name_of(label);
    this.root.style.transform = `translate(${x.toFixed(0)}px, ${(y + 18).toFixed(0)}px)${x > 0.7 * width ? " translate(-100%, 0)" : ""}`;
    this.timer = window.setTimeout(() => void this.complete(x, y), REST);
  }

  hide(): void {
    clearTimeout(this.timer);
    this.abort?.abort();
    this.abort = null;
    this.root.hidden = true;
    this.tell(null);
  }

  private async complete(x: number, y: number): Promise<void> {
    const abort = (this.abort = new AbortController());
    try {
      const seen = await this.ask(x, y, abort.signal);
      if (abort.signal.aborted || !seen) return;
      this.root.textContent = `${this.name_of(seen.label)} · cell ${seen.cell.join(", ")}`;
      this.tell(seen);
    } catch {
      // The name is there already; that the server is away is said elsewhere.
    }
  }
}
