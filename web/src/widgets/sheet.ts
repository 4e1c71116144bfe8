// A sheet at the lower edge of a phone, which is pulled up and down by its head. Where the style sheet does not fix it there, it does nothing.
import { useRef } from "preact/hooks";

const STILL = 6; // pixels that a tap may move
const LOWEST = 140; // pixels, below which it closes
const HIGHEST = 0.88; // of the window

// What was pulled is not clicked as well, although it has followed the pointer.
function swallow_click(): void {
  const swallow = (event: Event) => event.stopPropagation();
  addEventListener("click", swallow, { capture: true, once: true });
  setTimeout(() => removeEventListener("click", swallow, { capture: true }));
}

// `shown`: whether it is open. The style sheet takes its height from --sheet.
export function use_sheet(shown: boolean, show: (shown: boolean) => void) {
  const sheet = useRef<HTMLElement>(null);
  const onPointerDown = (event: PointerEvent) => {
    const element = sheet.current!;
    if (event.button !== 0 || getComputedStyle(element).position !== "fixed") return;
    const [from, before] = [event.clientY, element.offsetHeight];
    let height: number | null = null; // once it is pulled
    const pulling = new AbortController();
    const listen = (type: "pointermove" | "pointerup" | "pointercancel", call: (event: PointerEvent) => void) => addEventListener(type, call, { signal: pulling.signal });
    listen("pointermove", ({ clientY }) => {
      const up = from - clientY;
      if (height === null && Math.abs(up) < STILL) return;
      if (height === null && !shown && up > 0) show(true);
      height = Math.min(Math.max(before + up, 0), HIGHEST * innerHeight);
      element.style.setProperty("--sheet", `${height}px`);
    });
    const end = () => {
      pulling.abort();
      if (height === null) return;
      swallow_click();
      if (height >= LOWEST) return;
      element.style.removeProperty("--sheet");
      show(false);
    };
    listen("pointerup", end);
    listen("pointercancel", end);
  };
  return { sheet, head: { onPointerDown } };
}
