// Which grids are listed, and in which order. Pure.
import { product } from "../base/format";
import type { GridSummary } from "../base/grid";
import { by_name, contains } from "../base/names";
import type { Option } from "../widgets/select";

export type Order = "name" | "newest" | "cells" | "bytes";
export const ORDERS: readonly Option<Order>[] = [
  { value: "name", label: "by name" },
  { value: "newest", label: "newest first" },
  { value: "cells", label: "most cells first" },
  { value: "bytes", label: "largest file first" },
];

type Listed = Pick<GridSummary, "name" | "cells" | "bytes" | "modified">;

const compare: Record<Order, (a: Listed, b: Listed) => number> = {
  name: () => 0,
  newest: (a, b) => (b.modified ?? 0) - (a.modified ?? 0),
  cells: (a, b) => Number(product(b.cells)) - Number(product(a.cells)),
  bytes: (a, b) => b.bytes - a.bytes,
};

// The grids whose names contain a text. Equal ones are ordered by name.
export const listed = <T extends Listed>(grids: readonly T[], text: string, order: Order): T[] =>
  grids.filter(({ name }) => contains(name, text)).sort((a, b) => compare[order](a, b) || by_name(a.name, b.name));
