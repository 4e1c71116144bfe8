// Buttons of which one is pressed.
import type { ComponentChildren, ComponentProps } from "preact";

export type Segment<T> = Omit<ComponentProps<"button">, "value"> & { readonly value: T; readonly text: ComponentChildren };

interface Props<T> {
  readonly label: string;
  readonly value: T;
  readonly list: readonly Segment<T>[];
  set(value: T): void;
  readonly class?: string;
}

export function Segmented<T extends string | number>({ label, value, list, set, class: more = "" }: Props<T>) {
  return (
    <div class={`segmented ${more}`} role="group" aria-label={label}>
      {list.map(({ value: own, text, ...props }) => (
        <button key={own} {...props} aria-pressed={own === value} onClick={() => set(own)}>
          {text}
        </button>
      ))}
    </div>
  );
}
