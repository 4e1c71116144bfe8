// What a refined grid may be, and how many leaves it has.
import { AXES, type Index3, type LeafCount } from "./grid";

export const COARSEST = 16;
export const MOST_LAYERS = 100;
export const is_refinement = (coarsest: number, layers: number): boolean =>
  Number.isInteger(coarsest) && coarsest >= 0 && coarsest <= COARSEST && Number.isInteger(layers) && layers >= 1 && layers <= MOST_LAYERS;

const PARTS = 64;

// Slabs of a grid that no leaf lies across, so that they can be counted one after another. Each is a box of cells of level 0, half open.
export function slabs(cells: Index3, coarsest: number): [number, number, number, number, number, number][] {
  const longest = AXES.reduce((a, b) => (cells[b] > cells[a] ? b : a));
  const largest = 2 ** coarsest;
  const thick = Math.max(1, Math.ceil(cells[longest] / PARTS / largest)) * largest;
  return Array.from({ length: Math.ceil(cells[longest] / thick) }, (_, i) => {
    const [low, high]: [Index3, Index3] = [[0, 0, 0], [...cells]];
    low[longest] = i * thick;
    high[longest] = Math.min((i + 1) * thick, cells[longest]);
    return [...low, ...high];
  });
}

export function sum_of_counts(counts: readonly LeafCount[]): LeafCount {
  const leaves: LeafCount["leaves"] = [];
  for (const row of counts.flatMap((count) => count.leaves)) {
    const same = leaves.find(({ level, material }) => level === row.level && material === row.material);
    if (same) same.leaves += row.leaves;
    else leaves.push({ ...row });
  }
  leaves.sort((a, b) => a.level - b.level);
  return { total: counts.reduce((sum, { total }) => sum + total, 0), leaves };
}
