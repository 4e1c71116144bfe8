// Short messages to people, from any part of the page. toasts.tsx shows them. The same message is there only once at a time, and goes away by
// itself once there was time to read it, unless somebody holds it, as the pointer does. A detail may stand below it, and a command to be
// copied; messages that differ only in these count as the same.
import { signal } from "@preact/signals";

export interface Below {
  readonly detail?: string;
  readonly command?: string;
}
export interface Toast extends Below {
  readonly text: string;
  readonly times: number;
}

export const toasts = signal<readonly Toast[]>([]);
const MOST = 4;
const FIRST = 5000; // milliseconds until a message is noticed
const A_LETTER = 70; // milliseconds to read one
const A_COMMAND = 15_000; // to copy a command

const timers = new Map<string, ReturnType<typeof setTimeout>>();

const letters = ({ text, detail = "", command = "" }: Toast) => text.length + detail.length + command.length;
export const reading_time = (toast: Toast): number => FIRST + A_LETTER * letters(toast) + (toast.command ? A_COMMAND : 0);

export function drop(text: string): void {
  hold(text);
  toasts.value = toasts.value.filter((t) => t.text !== text);
}

// Keeps a message until it is released; then its time begins anew.
export function hold(text: string): void {
  clearTimeout(timers.get(text));
  timers.delete(text);
}
export function release(text: string): void {
  hold(text);
  const toast = toasts.value.find((t) => t.text === text);
  if (toast) timers.set(text, setTimeout(() => drop(text), reading_time(toast)));
}

// What is below a message that comes again stays that of the first one.
export function say(text: string, below: Below = {}): void {
  const before = toasts.value.find((t) => t.text === text);
  if (before) toasts.value = toasts.value.map((t) => (t === before ? { ...t, times: t.times + 1 } : t));
  else {
    for (const old of toasts.value.slice(0, 1 - MOST)) drop(old.text);
    toasts.value = [...toasts.value, { ...below, text, times: 1 }];
  }
  if (!before || timers.has(text)) release(text);
}

export const words_of = (error: unknown): string => (error instanceof Error ? error.message : String(error));
