// Says what is under the pointer: body, material and cell. What the picture knows is said at once; the cell is asked for
// when the pointer rests.
import { element } from "./dom";
import type { Seen } from "./sight/query";

const REST = 120; // milliseconds

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
      this.root.textContent = `${seen.name} · cell ${seen.cell.join(", ")}`;
      this.tell(seen);
    } catch {
      // The name is there already; that the server is away is said elsewhere.
    }
  }
}
