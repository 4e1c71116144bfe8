// Whole numbers as ranges in a text, for addresses: 1-4,7.
export function ranges(ascending: readonly number[]): string {
  const out: string[] = [];
  for (let i = 0; i < ascending.length; ) {
    let end = i;
    while (end + 1 < ascending.length && ascending[end + 1] === ascending[end]! + 1) ++end;
    out.push(end > i ? `${ascending[i]}-${ascending[end]}` : `${ascending[i]}`);
    i = end + 1;
  }
  return out.join(",");
}

// The numbers below `end` that a text names. What makes no sense in it is left out.
export function numbers_in(text: string, end: number): number[] {
  return text.split(",").flatMap((part) => {
    const [, first, last] = /^(\d{1,9})(?:-(\d{1,9}))?$/.exec(part) ?? [];
    if (first === undefined) return [];
    const [from, to] = [Number(first), Math.min(Number(last ?? first), end - 1)];
    return Array.from({ length: Math.max(0, to - from + 1) }, (_, i) => from + i);
  });
}
