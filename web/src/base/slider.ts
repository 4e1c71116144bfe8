// Where a key moves a slider to; null when it moves no slider. The slider keeps within its ends by itself.
export function slid_by_key(key: string, at: number, low: number, high: number, step = 1): number | null {
  if (key === "Home") return low;
  if (key === "End") return high;
  const steps = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[key];
  return steps === undefined ? null : at + steps * step;
}
