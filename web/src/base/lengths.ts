// Lengths for scale bars and measured lines, in the grid's units.
import { significant, unit_name } from "./format";

// The largest 1, 2 or 5 times a power of ten that is not above `most`.
export function round_length(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  const digit = most / power;
  return (digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power;
}

// Units whose lengths are known, in metres.
export const METRES: Readonly<Record<string, number>> = { m: 1, cm: 1e-2, mm: 1e-3, um: 1e-6, nm: 1e-9, in: 0.0254, ft: 0.3048 };

// Metric lengths get another unit where that reads better: 50 µm instead of 0.05 mm.
const NAMES: readonly [string, number][] = [
  ["km", 1e3],
  ["m", 1],
  ["mm", 1e-3],
  ["µm", 1e-6],
  ["nm", 1e-9],
];

export function length_text(length: number, units: string, digits = 4): string {
  const trimmed = (x: number) => significant(Number(x.toPrecision(digits)), digits).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "");
  const metres = units.endsWith("m") ? METRES[units] : undefined; // not of in and ft
  if (length === 0 || metres === undefined || (length >= 0.1 && length < 1e4)) return `${trimmed(length)} ${unit_name(units)}`;
  const [name, size] = NAMES.find(([, s]) => length * metres >= s * (1 - 1e-9)) ?? NAMES[NAMES.length - 1]!;
  return `${trimmed((length * metres) / size)} ${name}`;
}
