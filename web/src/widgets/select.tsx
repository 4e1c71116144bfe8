// One of several, from a list that opens.
export interface Option<T> {
  readonly value: T;
  readonly label: string;
}

interface Props<T> {
  readonly label: string;
  readonly value: T;
  readonly list: readonly Option<T>[];
  set(value: T): void;
  readonly class?: string;
}

export function Select<T extends string>({ label, value, list, set, class: look = "text-input" }: Props<T>) {
  return (
    <select class={look} aria-label={label} value={value} onChange={(e) => set(e.currentTarget.value as T)}>
      {list.map((item) => (
        <option key={item.value} value={item.value}>
          {item.label}
        </option>
      ))}
    </select>
  );
}
