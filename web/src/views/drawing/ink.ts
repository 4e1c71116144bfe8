// The colours of the style sheet, for what is painted on canvases. The browser resolves them, so any CSS notation
// works, and so does either theme.
import { type Rgb, packed } from "../../tiles/sets";

export interface Ink {
  readonly ground: Rgb; // of the grid, below materials that are transparent
  readonly outside: Rgb;
  readonly outline: number; // packed
  readonly stripes: readonly [number, number];
  readonly text: string;
  readonly halo: string; // around text and lines, so that they can be read on any material
  readonly plate: string; // under text
  readonly border: string;
  readonly line: Rgb; // between cells
  readonly accent: string;
  readonly marker: string;
  readonly differences: readonly number[]; // packed, by what differences.ts says of a pixel; clear where nothing differs
  readonly axes: readonly [string, string, string];
}

export function read_ink(host: HTMLElement): Ink {
  const probe = document.createElement("span");
  host.append(probe);
  const css = (name: string) => {
    probe.style.color = `var(--view-${name})`;
    return getComputedStyle(probe).color;
  };
  const rgb = (name: string): Rgb => {
    const parts = css(name).match(/[\d.]+/g)!.map(Number);
    return [parts[0]!, parts[1]!, parts[2]!];
  };
  const ink: Ink = {
    ground: rgb("ground"),
    outside: rgb("outside"),
    outline: packed(rgb("outline")),
    stripes: [packed(rgb("damaged")), packed(rgb("ground"))],
    text: css("text"),
    halo: css("halo"),
    plate: css("plate"),
    border: css("border"),
    line: rgb("line"),
    accent: css("accent"),
    marker: css("marker"),
    differences: [0, (packed(rgb("accent")) & 0x60ffffff) >>> 0, ...["partly", "differs", "removed", "added"].map((name) => packed(rgb(name)))],
    axes: [css("x"), css("y"), css("z")],
  };
  probe.remove();
  return ink;
}
