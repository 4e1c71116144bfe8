// Short messages that come by themselves: read aloud, the same one only once at a time, gone after a while. A detail stands below, cut to
// a line; messages that differ in it alone are the same.
import { signal } from "@preact/signals";
import { Icon } from "./icons";

interface Toast {
  text: string;
  detail: string | undefined; // of the first
  times: number;
  timer: number;
}

const toasts = signal<readonly Toast[]>([]);
const SECONDS = 10;

const drop = (text: string) => (toasts.value = toasts.value.filter((t) => t.text !== text));

export function say(text: string, detail?: string): void {
  const before = toasts.value.find((t) => t.text === text);
  clearTimeout(before?.timer);
  const toast = { text, detail: before?.detail ?? detail, times: (before?.times ?? 0) + 1, timer: window.setTimeout(() => drop(text), 1000 * SECONDS) };
  toasts.value = before ? toasts.value.map((t) => (t === before ? toast : t)) : [...toasts.value.slice(-3), toast];
}

export function Toasts() {
  return (
    <div class="toasts" role="status" aria-live="polite">
      {toasts.value.map((t) => (
        <div class="toast" key={t.text}>
          <span class="toast-text">
            {t.text}
            {t.detail && (
              <span class="toast-detail" title={t.detail}>
                {t.detail}
              </span>
            )}
          </span>
          {t.times > 1 && <span class="faint">×{t.times}</span>}
          <button class="icon-button" aria-label="Dismiss this message" onClick={() => drop(t.text)}>
            <Icon name="close" />
          </button>
        </div>
      ))}
    </div>
  );
}
