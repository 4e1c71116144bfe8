// Short messages to people, from any part of the page. toasts.tsx shows them. The same message is there only once at a
// time and disappears after a while. A detail may stand below it, cut to one line; messages that differ only in their
// detail count as the same.
import { signal } from "@preact/signals";

export interface Toast {
  text: string;
  detail: string | undefined; // of the first one of them
  times: number;
  timer: ReturnType<typeof setTimeout>;
}

export const toasts = signal<readonly Toast[]>([]);
const SECONDS = 10;

export const drop = (text: string) => (toasts.value = toasts.value.filter((t) => t.text !== text));

export function say(text: string, detail?: string): void {
  const before = toasts.value.find((t) => t.text === text);
  clearTimeout(before?.timer);
  const toast = {
    text,
    detail: before?.detail ?? detail,
    times: (before?.times ?? 0) + 1,
    timer: setTimeout(() => drop(text), 1000 * SECONDS),
  };
  toasts.value = before ? toasts.value.map((t) => (t === before ? toast : t)) : [...toasts.value.slice(-3), toast];
}

export const words_of = (error: unknown): string => (error instanceof Error ? error.message : String(error));
