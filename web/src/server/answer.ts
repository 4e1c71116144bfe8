// The answer of the server at an address, for a component. It is fetched when the address changes. Until it comes the
// earlier answer stays, so that nothing flickers. When a lost server is back, it is fetched again. `fetch_it`: how it is
// fetched, where that takes more than one request.
import { useEffect, useState } from "preact/hooks";
import { words_of } from "../base/messages";
import { get_json, is_version_gone } from "./api";
import { returned } from "./connection";

export interface Answer<T> {
  value: T | null;
  path: string | null; // the address that gave the value
  error: string | null;
}

export function use_answer<T>(path: string | null, fetch_it: (path: string, signal: AbortSignal) => Promise<T> = get_json): Answer<T> {
  const [answer, set_answer] = useState<Answer<T>>({ value: null, path: null, error: null });
  const again = returned.value;
  useEffect(() => {
    if (path === null) return;
    const abort = new AbortController();
    set_answer((before) => (before.error === null ? before : { ...before, error: null }));
    fetch_it(path, abort.signal).then(
      (value) => abort.signal.aborted || set_answer({ value, path, error: null }),
      (error: unknown) => {
        if (!abort.signal.aborted && !is_version_gone(error, path)) set_answer((before) => ({ ...before, error: words_of(error) }));
      },
    );
    return () => abort.abort();
  }, [path, again]);
  return answer;
}

// The value once it has stood still for a while, so that a drag does not send a request at every step.
export function use_settled<T>(value: T, milliseconds: number): T {
  const [settled, set_settled] = useState(value);
  useEffect(() => {
    const timer = setTimeout(() => set_settled(value), milliseconds);
    return () => clearTimeout(timer);
  }, [value, milliseconds]);
  return settled;
}
