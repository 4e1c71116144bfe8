// Materials or bodies that are parts of an assembly, as its tree: what is below a branch is hidden, shown alone and coloured at once.
import { useState } from "preact/hooks";
import { grouped } from "../base/format";
import type { Amount } from "../base/grid";
import type { MaterialLook } from "../base/materials";
import { type Branch, type Leaf, is_branch } from "../base/part_tree";
import type { Viewer } from "../state/viewer";
import { FirstOf } from "./first_of";
import { type Item, LookCard, LookHead, Opacity } from "./look_card";

const STEP = 100; // children that are shown at once
const FEW = 30; // items of a tree that is unfolded from the start

// The same as an item does for itself, for several by their ids.
export interface ManyAtOnce {
  change(ids: readonly number[], what: Partial<MaterialLook>): void;
  show_only(ids: readonly number[]): void;
  show_all(): void;
  go_there(ids: readonly number[]): void;
}

// What is below a branch, as one item. It is seen when any of it is, and has the colour of the first.
export function together(items: readonly Item[], { name, path, places }: Branch, many: ManyAtOnce): Item {
  const below = places.map((place) => items[place]!);
  const ids = below.map(({ id }) => id);
  const shown = below.filter(({ look }) => look.visible).length;
  const alone = shown === below.length && shown === items.filter(({ look }) => look.visible).length;
  const sum = (of: (amount: Amount) => number) => below.reduce((n, { amount }) => n + of(amount!), 0);
  return {
    id: -1,
    name: path,
    title: name,
    beside: shown === below.length || shown === 0 ? grouped(below.length) : `${grouped(shown)} of ${grouped(below.length)}`,
    look: { ...below[0]!.look, visible: shown > 0 },
    alone,
    amount: below[0]!.amount && { cells: sum(({ cells }) => cells), volume: sum(({ volume }) => volume), box: null },
    change: (what) => many.change(ids, what),
    show_alone: () => (alone ? many.show_all() : many.show_only(ids)),
    go_there: () => many.go_there(ids),
  };
}

interface Props {
  readonly viewer: Viewer;
  readonly items: readonly Item[];
  readonly all: number; // cells of the grid
  readonly many_at_once: ManyAtOnce;
}

function BranchCard({ branch, first, ...props }: Props & { branch: Branch; first: boolean }) {
  const [opened, set_opened] = useState(first || props.items.length <= FEW);
  const item = together(props.items, branch, props.many_at_once);
  return (
    <li class={`material is-short ${item.look.visible ? "" : "is-hidden"}`}>
      <LookHead item={item} all={props.all} opened={opened} set_opened={set_opened} />
      {opened && <Opacity item={item} />}
      {opened && <Children {...props} list={branch.children} class="materials branch" first={first && branch.children.length === 1} />}
    </li>
  );
}

function Children({ list, class: look, first, ...props }: Props & { list: readonly (Branch | Leaf)[]; class: string; first: boolean }) {
  const { viewer, items, all } = props;
  return (
    <FirstOf class={look} list={list} step={STEP}>
      {(child) =>
        is_branch(child) ? (
          <BranchCard key={child.path} {...props} branch={child} first={first} />
        ) : (
          <LookCard key={child.place} short={true} viewer={viewer} item={{ ...items[child.place]!, title: child.name }} all={all} />
        )
      }
    </FirstOf>
  );
}

export function LookTree({ tree, ...props }: Props & { tree: readonly (Branch | Leaf)[] }) {
  return <Children {...props} list={tree} class="materials" first={true} />;
}
