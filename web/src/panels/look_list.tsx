// A list of materials or bodies. When it is long there is a filter, an order to choose, and each item is one line that can
// be opened. The parts of an assembly are its tree, as long as no other order is asked for.
import { useMemo, useState } from "preact/hooks";
import { grouped } from "../base/format";
import { by_name, contains } from "../base/names";
import { part_tree } from "../base/part_tree";
import type { Viewer } from "../state/viewer";
import { type Option, Select } from "../widgets/select";
import { FirstOf } from "./first_of";
import { type Item, LookCard } from "./look_card";
import { LookTree, type ManyAtOnce } from "./look_tree";

const MANY = 8;
const STEP = 100; // items that are shown at once

type Order = "own" | "name" | "most" | "fewest";
const ORDERS: readonly Option<Order>[] = [
  { value: "own", label: "as in the scene" },
  { value: "name", label: "by name" },
  { value: "most", label: "most cells first" },
  { value: "fewest", label: "fewest cells first" },
];

export function ordered<T extends Pick<Item, "name" | "amount">>(items: readonly T[], order: Order): readonly T[] {
  if (order === "own") return items;
  if (order === "name") return [...items].sort((a, b) => by_name(a.name, b.name));
  const sign = order === "most" ? -1 : 1;
  return [...items].sort((a, b) => sign * ((a.amount?.cells ?? 0) - (b.amount?.cells ?? 0)));
}

// Items whose names contain a text; what stands beside a name counts too, and so do the bodies of a material.
export const matching = <T extends Pick<Item, "name" | "beside" | "bodies">>(items: readonly T[], text: string): readonly T[] =>
  items.filter(({ name, beside, bodies = [] }) => contains(`${name} ${beside}`, text) || bodies.some((body) => contains(body, text)));

interface Props {
  readonly viewer: Viewer;
  readonly items: readonly Item[];
  readonly what: string; // as in "Filter 300 materials"
  readonly count?: number; // of those that are meant; default: all items
  readonly all: number; // cells of the grid
  readonly of_found?: (found: readonly Item[]) => preact.ComponentChildren; // what can be done with those that the filter finds
  readonly many_at_once: ManyAtOnce;
}

export function LookList({ viewer, items, what, count = items.length, all, of_found, many_at_once }: Props) {
  const [filter, set_filter] = useState("");
  const [order, set_order] = useState<Order>("own");
  const tree = useMemo(() => part_tree(items.map(({ name }) => name)), [viewer.info]);
  const many = items.length > MANY;
  const found = many ? ordered(matching(items, filter), order) : items;
  const as_tree = tree && (!many || (filter.trim() === "" && order === "own"));
  return (
    <>
      {many && (
        <div class="list-choice">
          <input
            class="text-input"
            type="search"
            placeholder={`Filter ${grouped(count)} ${what}`}
            aria-label={`Filter ${what} by name`}
            value={filter}
            onInput={(e) => set_filter(e.currentTarget.value)}
          />
          <Select label={`Order of the ${what}`} value={order} list={ORDERS} set={(to) => set_order(to)} />
        </div>
      )}
      {filter.trim() !== "" && found.length > 0 && of_found?.(found)}
      {as_tree ? (
        <LookTree viewer={viewer} tree={tree} items={items} all={all} many_at_once={many_at_once} />
      ) : (
        <FirstOf class="materials" list={found} step={STEP}>
          {(item) => <LookCard key={item.id} short={many} viewer={viewer} item={item} all={all} />}
        </FirstOf>
      )}
      {found.length === 0 && <p class="note">No name contains this text.</p>}
    </>
  );
}
