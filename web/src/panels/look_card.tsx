// A material or a body in a list: how it looks, and how much of the grid it fills.
import { useState } from "preact/hooks";
import { grouped, percent, significant } from "../base/format";
import type { Amount } from "../base/grid";
import { some_names } from "../base/names";
import { type MaterialLook, css_color, hex_color, rgb_of_color } from "../base/materials";
import type { Viewer } from "../state/viewer";
import { Fact } from "../widgets/fact";
import { IconButton } from "../widgets/icons";
import { BoxText } from "./places";

export const cells_of = (amount: Amount): string => grouped(amount.cells_text ?? amount.cells);

export interface Item {
  readonly id: number; // of the material, or the label of the body
  readonly name: string;
  readonly title?: string; // what is read instead of the name, where a tree says the rest of it
  readonly beside: string; // what stands behind the name, in faint letters
  readonly bodies?: readonly string[]; // of a material: those that look like it, where the file doesn't keep bodies apart
  readonly look: MaterialLook;
  readonly alone: boolean; // whether nothing else is shown
  readonly amount: Amount | null; // null while it is not known
  change(what: Partial<MaterialLook>): void;
  show_alone(): void; // shows it alone, or everything when it is alone already
  go_there(): void;
}

interface Props {
  readonly viewer: Viewer;
  readonly item: Item;
  readonly all: number; // cells of the grid
}

export function Opacity({ item }: { item: Item }) {
  const text = `${Math.round(100 * item.look.opacity)} %`;
  return (
    <label class="opacity">
      opacity
      <input
        type="range"
        min={0}
        max={100}
        value={Math.round(100 * item.look.opacity)}
        title={`Opacity ${text}`}
        aria-label={`Opacity of ${item.name}`}
        aria-valuetext={text}
        onInput={(e) => item.change({ opacity: Number(e.currentTarget.value) / 100 })}
      />
      <span class="share">{text}</span>
    </label>
  );
}

// The bodies that an item's controls are for, where its name does not say it.
const concerned = ({ name, bodies = [] }: Item): string => (bodies.length > 1 || (bodies[0] ?? name) !== name ? some_names(bodies) : "");

function AmountFacts({ viewer, item, all }: Props) {
  const { look, amount } = item;
  const share = amount ? amount.cells / all : 0;
  return (
    <>
      <div class="share-bar" aria-hidden="true">
        <span style={{ width: `${100 * share}%`, background: look.opacity > 0 ? css_color(look) : "var(--line-strong)" }} />
      </div>
      <Opacity item={item} />
      <dl class="numbers">
        <Fact name="cells">
          {amount ? cells_of(amount) : "…"} <span class="share">{amount ? percent(share) : ""}</span>
        </Fact>
        <Fact name="volume">{amount ? `${significant(amount.volume, 6)} ${viewer.units}³` : "…"}</Fact>
      </dl>
      {amount?.box ? (
        <details class="material-box">
          <summary>Bounding box</summary>
          <BoxText viewer={viewer} box={amount.box} />
        </details>
      ) : (
        amount && <p class="note">It owns no cell.</p>
      )}
    </>
  );
}

interface HeadProps {
  readonly item: Item;
  readonly all: number;
  readonly opened: boolean;
  readonly set_opened?: (opened: boolean) => void; // none: it can't be closed
}

// The line of an item: its colour, its name, whether it is seen.
export function LookHead({ item, all, opened, set_opened }: HeadProps) {
  const { name, look } = item;
  const bodies = concerned(item);
  const beside = item.beside || bodies;
  const what = bodies && ` ${name}: ${bodies}`;
  const Title = set_opened ? "button" : "span";
  return (
    <div class={`material-head ${opened ? "is-open" : ""}`}>
      <input
        type="color"
        title={`Colour of ${what.trim() || name}`}
        aria-label={`Colour of ${name}`}
        value={hex_color(look)}
        style={{ "--opacity": look.opacity }}
        onInput={(e) => item.change({ color: rgb_of_color(e.currentTarget.value) })}
      />
      <Title
        class="material-title"
        title={`${name} ${beside}`}
        {...(set_opened && { "aria-expanded": opened, onClick: () => set_opened(!opened) })}
      >
        <bdi>{item.title ?? name}</bdi>
        {beside && <span class="faint"> {beside}</span>}
      </Title>
      {!opened && <span class="share">{item.amount ? percent(item.amount.cells / all) : "…"}</span>}
      <IconButton
        icon={look.visible ? "eye" : "hidden"}
        label={`Show ${name}`}
        title={`${look.visible ? "Hide" : "Show"}${what}`}
        aria-pressed={look.visible}
        onClick={() => item.change({ visible: !look.visible })}
      />
      <IconButton icon="target" label={`Go there: ${name}`} title="Go there: show it in full, and all else faint" onClick={item.go_there} />
      <IconButton icon="solo" label={`Only ${name}`} title="Show nothing else" aria-pressed={item.alone} onClick={item.show_alone} />
    </div>
  );
}

// With `short`, it is one line until it is opened.
export function LookCard({ short, ...props }: Props & { short: boolean }) {
  const { item, all } = props;
  const [opened, set_opened] = useState(!short);
  return (
    <li class={`material ${item.look.visible ? "" : "is-hidden"} ${short ? "is-short" : ""}`}>
      <LookHead item={item} all={all} opened={opened} {...(short && { set_opened })} />
      {opened && <AmountFacts {...props} />}
    </li>
  );
}
