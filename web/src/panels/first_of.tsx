// A list that may be very long: its first items, and as many more for each click.
import { useState } from "preact/hooks";
import { grouped } from "../base/format";

export function FirstOf<T>({ class: look, list, step, children }: {
  class: string;
  list: readonly T[];
  step: number;
  children: (item: T, n: number) => preact.ComponentChildren;
}) {
  const [most, set_most] = useState(step);
  const more = list.length - most;
  return (
    <ul class={look}>
      {list.slice(0, most).map(children)}
      {more > 0 && (
        <li class="more">
          <button class="button small" onClick={() => set_most(most + step)}>
            {grouped(more)} more
          </button>
        </li>
      )}
    </ul>
  );
}
