// Reads the text of /metrics, and compares two of them: rates, shares, and how long the answers in between took.

export interface Sample {
  name: string;
  labels: Readonly<Record<string, string>>;
  value: number;
}

const LINE = /^([a-zA-Z_:][\w:]*)(?:\{(.*)\})?\s+(\S+)/;
const LABEL = /(\w+)="((?:[^"\\]|\\.)*)"/g;
const ESCAPES: Readonly<Record<string, string>> = { "\\n": "\n", '\\"': '"', "\\\\": "\\" };

export function parse_metrics(text: string): Sample[] {
  const samples: Sample[] = [];
  for (const line of text.split("\n")) {
    const found = LINE.exec(line);
    if (!found) continue;
    const labels: Record<string, string> = {};
    for (const [, key, value] of (found[2] ?? "").matchAll(LABEL)) labels[key!] = value!.replace(/\\[n"\\]/g, (e) => ESCAPES[e]!);
    const value = found[3] === "+Inf" ? Infinity : Number(found[3]);
    if (!Number.isNaN(value)) samples.push({ name: found[1]!, labels, value });
  }
  return samples;
}

// The sum of all samples of a name that have these labels; 0 when there are none.
export function total(samples: readonly Sample[], name: string, labels: Readonly<Record<string, string>> = {}): number {
  let sum = 0;
  for (const s of samples) if (s.name === name && Object.entries(labels).every(([k, v]) => s.labels[k] === v)) sum += s.value;
  return sum;
}

export const label_values = (samples: readonly Sample[], name: string, label: string): string[] => [
  ...new Set(samples.filter((s) => s.name === name).map((s) => s.labels[label] ?? "")),
];

// A bucket of a histogram. Its count is its own, not cumulative. Requests that only watch the server (NOT_WORK) are left out.
export interface Bucket {
  le: number;
  count: number;
}
const NOT_WORK = ["metrics", "healthz"];

export function buckets(samples: readonly Sample[], name: string): Bucket[] {
  const sums = new Map<number, number>();
  for (const s of samples) {
    if (s.name !== `${name}_bucket` || NOT_WORK.includes(s.labels.route ?? "")) continue;
    const le = s.labels.le === "+Inf" ? Infinity : Number(s.labels.le);
    sums.set(le, (sums.get(le) ?? 0) + s.value);
  }
  const sorted = [...sums].sort(([a], [b]) => a - b);
  return sorted.map(([le, sum], n) => ({ le, count: sum - (n > 0 ? sorted[n - 1]![1] : 0) }));
}

export function since(now: readonly Bucket[], before: readonly Bucket[]): Bucket[] {
  const old = new Map(before.map((b) => [b.le, b.count]));
  return now.map((b) => ({ le: b.le, count: Math.max(0, b.count - (old.get(b.le) ?? 0)) }));
}

// The bounds of the bucket in which the quantile lies: a histogram knows no more.
export function quantile(list: readonly Bucket[], q: number): { from: number; to: number } | null {
  const count = list.reduce((n, b) => n + b.count, 0);
  if (count === 0) return null;
  let sum = 0;
  for (const [n, bucket] of list.entries()) {
    sum += bucket.count;
    if (sum >= q * count) return { from: n > 0 ? list[n - 1]!.le : 0, to: bucket.le };
  }
  return null;
}
