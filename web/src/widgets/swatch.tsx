// The colour of a material, or a checkerboard where nothing of it is seen.
import { type MaterialLook, css_color } from "../base/materials";

export function Swatch({ look }: { look: MaterialLook | undefined }) {
  const clear = !look || look.opacity === 0 || !look.visible;
  return <span class={`swatch ${clear ? "clear" : ""}`} style={clear ? {} : { background: css_color(look) }} />;
}
