// The parts in which a picture is asked for, since what has come can be shown. Pure.

// Pixels from the upper left corner, half open.
export interface Part {
  readonly x0: number;
  readonly y0: number;
  readonly x1: number;
  readonly y1: number;
}

// With sides of at most so many pixels, from the middle outwards.
export function parts_of(width: number, height: number, side: number): Part[] {
  const parts: Part[] = [];
  const cuts = (length: number) => {
    const count = Math.ceil(length / side);
    return Array.from({ length: count + 1 }, (_, i) => Math.round((i * length) / count));
  };
  const [columns, rows] = [cuts(width), cuts(height)];
  for (let j = 0; j + 1 < rows.length; ++j)
    for (let i = 0; i + 1 < columns.length; ++i) parts.push({ x0: columns[i]!, y0: rows[j]!, x1: columns[i + 1]!, y1: rows[j + 1]! });
  const off = ({ x0, y0, x1, y1 }: Part) => Math.hypot(x0 + x1 - width, y0 + y1 - height);
  return parts.sort((a, b) => off(a) - off(b));
}
