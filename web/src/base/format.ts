// Numbers as people read them: thin spaces between thousands, as many digits as the size of a cell warrants, a true
// minus sign. Also numbers as people type them.

const THIN = "\u202f"; // narrow, and lines do not break at it
const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

const with_minus = (text: string) => text.replace("-", "−");
const superscript = (n: number) => [...String(n)].map((c) => (c === "-" ? "⁻" : SUPERSCRIPTS[Number(c)]!)).join("");

// 1234567 becomes 1 234 567. Text is taken as well, for counts that no double holds.
export function grouped(n: number | bigint | string): string {
  const [whole, fraction] = String(n).split(".");
  const spaced = whole!.replace(/\B(?=(\d{3})+$)/g, THIN);
  return with_minus(fraction === undefined ? spaced : `${spaced}.${fraction}`);
}

// A count that is too long to be read, with three digits: 1.5 × 10⁹.
export function about(n: number | bigint): string {
  const x = Number(n);
  if (Math.abs(x) < 1e6) return grouped(Math.round(x));
  const [digits, exponent] = x.toExponential(2).split("e") as [string, string];
  const power = `10${superscript(Number(exponent))}`;
  return digits === "1.00" ? power : `${digits.replace(/\.?0+$/, "")} × ${power}`;
}

// A sentence of the server's as people read it: with true minus signs, and thin spaces between thousands.
export const prose = (text: string): string =>
  text.replace(/(^|[\s(])-(?=[\d.])/g, "$1−").replace(/\d{1,3}(,\d{3})+(?![\d])/g, (number) => number.replaceAll(",", THIN));

// How many decimals a coordinate needs to show a tenth of a cell of this size.
export function decimals(step: number): number {
  if (!(step > 0)) return 3;
  return Math.min(Math.max(Math.ceil(-Math.log10(step) - 1e-9) + 1, 0), 12);
}

export function coordinate(x: number, step: number): string {
  const text = x.toFixed(decimals(step));
  return grouped(Number(text) === 0 ? text.replace("-", "") : text);
}

// A length, an area or a volume with this many significant digits. Very large and very small ones get a power of ten.
export function significant(x: number, digits = 5): string {
  if (x === 0 || !Number.isFinite(x)) return String(x);
  const size = Math.floor(Math.log10(Math.abs(x)));
  if (size < -4 || size > 14) {
    const [m, e] = x.toExponential(digits - 1).split("e") as [string, string];
    return `${with_minus(m)} × 10${superscript(Number(e))}`;
  }
  return grouped(x.toFixed(Math.min(Math.max(digits - 1 - size, 0), 100)));
}

// The unit as people write it. Output for other programs keeps the spelling of the scene.
export const unit_name = (units: string): string => (units === "um" ? "µm" : units);

export function bytes_text(n: number): string {
  const units = ["B", "kB", "MB", "GB", "TB", "PB", "EB"];
  let at = 0;
  let x = n;
  while (x >= 999.5 && at + 1 < units.length) {
    x /= 1000;
    ++at;
  }
  return `${at === 0 ? x : x.toPrecision(3)} ${units[at]}`;
}

// A share as a percentage: 12.3 %. A share that is tiny, but not zero, never shows as 0 %.
export function percent(part: number): string {
  if (part === 0) return "0 %";
  if (part === 1) return "100 %";
  const p = 100 * part;
  if (p < 0.001) return "< 0.001 %";
  if (p > 99.99) return "> 99.99 %";
  return `${p < 0.1 ? p.toPrecision(1) : p < 10 ? p.toFixed(2) : p.toFixed(1)} %`;
}

export function milliseconds(ms: number): string {
  if (!Number.isFinite(ms)) return "–";
  if (ms >= 1000) return `${(ms / 1000).toPrecision(3)} s`;
  return `${ms < 10 ? ms.toFixed(1) : Math.round(ms)} ms`;
}

export const clock = (time: number | Date): string => new Date(time).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });

export const noun = (n: number | bigint | string, one: string, many = `${one}s`): string => (String(n) === "1" ? one : many);
export const plural = (n: number | bigint | string, one: string, many?: string): string => `${grouped(n)} ${noun(n, one, many)}`;

export const product = (cells: readonly number[]): bigint => cells.reduce((n, c) => n * BigInt(c), 1n);
export const sizes = (cells: readonly number[]): string => cells.map((c) => grouped(c)).join(" × ");

// The number that somebody typed or copied from this page: with spaces between digits, a true minus sign, and commas
// where they can have only one meaning. null when it is not a number.
export function number_of(text: string, whole = false): number | null {
  const plain = text.trim().replace("−", "-").replace(/(\d)\s+(?=\d)/g, "$1");
  const thousands = /^-?[1-9]\d{0,2}(,\d{3})+(\.\d*)?$/.test(plain);
  if (thousands && !whole && /^[^,]*,\d*$/.test(plain)) return null; // 5,000 may mean five thousand, or five
  const n = Number(thousands ? plain.replaceAll(",", "") : plain.replace(",", "."));
  return plain !== "" && Number.isFinite(n) ? n : null;
}

// A name for a CSV file. Spreadsheets take some first characters for the start of a formula, and anybody may have
// chosen the name: an apostrophe marks it as text.
export function csv_name(name: string): string {
  const text = /^[=+\-@\t\r]/.test(name) ? `'${name}` : name;
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

// As it begins a sentence.
export const upper_first = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);
