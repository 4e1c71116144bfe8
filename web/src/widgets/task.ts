// For buttons that begin something: whether it is under way, and what begins it.
import { useState } from "preact/hooks";
import { say, words_of } from "../base/messages";

// `fault`: what is said, before the reason, when it fails.
export function use_task(task: () => Promise<void>, fault: string): { busy: boolean; start: () => void } {
  const [busy, set_busy] = useState(false);
  const run = async () => {
    set_busy(true);
    try {
      await task();
    } catch (error) {
      say(`${fault}: ${words_of(error)}.`);
    }
    set_busy(false);
  };
  return { busy, start: () => void run() };
}
