// The list of the grids that are served, with pictures, or why there is nothing to show.
import type { Ref } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { grouped, plural } from "../base/format";
import type { GridSummary, UnreadableFile } from "../base/grid";
import { contains } from "../base/names";
import { asked_elsewhere, can_read_files, open_files } from "../module/own_grids";
import { is_alone } from "../server/transport";
import { by_touch } from "../state/phone";
import { Icon } from "../widgets/icons";
import { Select } from "../widgets/select";
import { Card } from "./card";
import { ORDERS, type Order, listed } from "./listing";

const FEW = 4; // grids that need no search

function UnreadableCard({ file, element }: { file: UnreadableFile; element: Ref<HTMLLIElement> | null }) {
  return (
    <li class="card unreadable" ref={element} tabIndex={-1}>
      <h2>
        <Icon name="warning" /> {file.id}
      </h2>
      <p>This file can't be read: {file.error}</p>
    </li>
  );
}

// `jump` leads to the files that can't be read, which come after the grids.
function Headline({ readable, broken, jump }: { readable: number; broken: number; jump(): void }) {
  const unreadable = broken > 0 && `${plural(broken, "file")} that can't be read`;
  if (readable === 0) return <h1>{unreadable}</h1>;
  return (
    <h1>
      {readable === 1 ? "One grid" : `${grouped(readable)} grids`}
      {unreadable && ", "}
      {unreadable && <button onClick={jump}>{unreadable}</button>}
    </h1>
  );
}

function Empty() {
  if (is_alone())
    return (
      <div class="empty">
        <h1>Open a grid</h1>
        <p>Choose .tcell files on your machine, or drop them here. This page reads them by itself: nothing is uploaded.</p>
        <FileChoice />
        <p class="note">A grid is made from triangle surfaces by the program teracell:</p>
        <pre>teracell mesh part.stl --cells 2000 -o part.tcell</pre>
      </div>
    );
  return (
    <div class="empty">
      <h1>No grid here yet</h1>
      <p>
        The server is running, but it has no grid to serve. Make one and put it into the folder that is served. It will appear here by itself.
      </p>
      <pre>teracell mesh part.stl --cells 2000 -o part.tcell</pre>
      {can_read_files && <p>Or open a file of your machine. The page reads it by itself: nothing is uploaded.</p>}
      <FileChoice />
    </div>
  );
}

// Opens files of this machine. Nothing is uploaded.
function FileChoice() {
  const input = useRef<HTMLInputElement>(null);
  if (!can_read_files) return null;
  return (
    <div class="file-choice">
      <input
        ref={input}
        type="file"
        accept=".tcell"
        multiple
        hidden
        aria-label="Files to open"
        onChange={(e) => e.currentTarget.files && void open_files([...e.currentTarget.files])}
      />
      <button class="button" title="Files of this machine; nothing is uploaded" onClick={() => input.current!.click()}>
        <Icon name="open" /> Open files …
      </button>
    </div>
  );
}

interface ChoiceProps {
  readonly text: string;
  readonly order: Order;
  search(text: string): void;
  open(): void; // what is found, by Enter
  sort(order: Order): void;
}

// "/" leads to the search, as on many pages.
function Choice({ text, order, search, open, sort }: ChoiceProps) {
  const field = useRef<HTMLInputElement>(null);
  useEffect(() => {
    const on_key = (event: KeyboardEvent) => {
      if (event.key !== "/" || event.ctrlKey || event.metaKey || event.altKey || document.activeElement === field.current) return;
      event.preventDefault();
      field.current?.focus();
    };
    addEventListener("keydown", on_key);
    return () => removeEventListener("keydown", on_key);
  }, []);
  return (
    <div class="list-choice" role="search">
      <input
        ref={field}
        class="text-input"
        type="search"
        placeholder={by_touch ? "Search by name" : "Search by name ( / )"}
        aria-label="Search grids by name"
        value={text}
        onInput={(e) => search(e.currentTarget.value)}
        onKeyDown={(e) => e.key === "Enter" && open()}
      />
      <Select label="Order of the grids" value={order} list={ORDERS} set={sort} />
    </div>
  );
}

function List({ grids, broken }: { grids: readonly GridSummary[]; broken: readonly UnreadableFile[] }) {
  const [text, set_text] = useState("");
  const [order, set_order] = useState<Order>("name");
  const many = grids.length > FEW;
  const found = many ? listed(grids, text, order) : grids;
  const unreadable = many ? broken.filter(({ id }) => contains(id, text)) : broken;
  const searched = many && text.trim() !== "";
  const first_unreadable = useRef<HTMLLIElement>(null);
  const [jumps, set_jumps] = useState(0);
  useEffect(() => {
    if (jumps === 0) return;
    first_unreadable.current?.focus({ preventScroll: true });
    first_unreadable.current?.scrollIntoView();
  }, [jumps]);
  const jump = () => {
    set_text("");
    set_jumps(jumps + 1);
  };
  const open_only = () => {
    if (searched && found.length === 1) location.hash = `#g=${encodeURIComponent(found[0]!.id)}`;
  };
  return (
    <>
      <div class="start-head">
        <Headline readable={grids.length} broken={broken.length} jump={jump} />
        {many && <Choice text={text} order={order} search={set_text} open={open_only} sort={set_order} />}
        {asked_elsewhere && (
          <a class="button" href={location.pathname}>
            <Icon name="list" /> All grids here
          </a>
        )}
        <FileChoice />
      </div>
      <p class="note" role="status">
        {searched && (found.length + unreadable.length === 0 ? "No name contains this text." : `${grouped(found.length + unreadable.length)} found.`)}
      </p>
      <ul class="cards">
        {found.map((grid) => (
          <Card key={`${grid.id} ${grid.hash} ${grid.modified}`} grid={grid} />
        ))}
        {unreadable.map((file, n) => (
          <UnreadableCard key={`${n} ${file.id}`} file={file} element={n === 0 ? first_unreadable : null} />
        ))}
      </ul>
    </>
  );
}

interface Props {
  readonly grids: readonly GridSummary[] | null; // null while they are not known
  readonly unreadable: readonly UnreadableFile[];
  readonly waiting: string | null; // the grid that is being opened
  readonly trouble: string | null; // why nothing could be opened
}

export function StartPage({ grids, unreadable, waiting, trouble }: Props) {
  if (waiting || (grids === null && !trouble))
    return <main class="start" aria-busy="true" aria-label={waiting ? `Opening ${waiting}` : "Looking for grids"} />;
  return (
    <main class="start">
      {trouble && (
        <p class="problem start-trouble" role="alert">
          {trouble}
        </p>
      )}
      {grids && (grids.length + unreadable.length > 0 ? <List grids={grids} broken={unreadable} /> : <Empty />)}
    </main>
  );
}
