// The field that leads to a place: coordinates, a cell, or a name. What Enter will do stands below it, the likeliest first.
import { useSignal } from "@preact/signals";
import { useLayoutEffect, useMemo, useRef } from "preact/hooks";
import { coordinate, grouped } from "./base/format";
import { AXES, AXIS_NAMES } from "./base/grid";
import { contains } from "./base/names";
import { type NamedPlace, named_places, places_named } from "./state/named_places";
import { say_of_place } from "./state/outside";
import { type Spot, spots_of } from "./state/place_text";
import type { Viewer } from "./state/viewer";
import { go_to_labels } from "./visits/go_there";
import { Icon, IconButton } from "./widgets/icons";

const MOST = 8; // names that are suggested

interface Goal {
  readonly key: string;
  readonly text: string;
  readonly beside: string;
  readonly outside: string | null;
  go(): void;
}

function goal_of_spot(viewer: Viewer, { by, point, cell, outside }: Spot): Goal {
  const coordinates = AXES.map((d) => `${AXIS_NAMES[d]} ${coordinate(point[d], viewer.axes[d].width(cell[d]))}`).join(", ");
  const indices = `cell ${cell.map((i) => grouped(i)).join(", ")}`;
  const texts = [`${coordinates} ${viewer.units}`, indices] as const;
  const [text, beside] = by === "cell" ? [texts[1], texts[0]] : texts;
  const go = () => {
    viewer.look_at_cell(cell);
    if (outside) say_of_place(viewer, outside);
  };
  return { key: by, text, beside, outside, go };
}

// The labels that carry a name.
const labels_of = (viewer: Viewer, { of, ids }: NamedPlace): readonly number[] =>
  of === "bodies" ? ids : viewer.labels.flatMap(({ material }, label) => (ids.includes(material) ? [label] : []));

function goal_of_name(viewer: Viewer, place: NamedPlace): Goal {
  const go = () => void go_to_labels(viewer, labels_of(viewer, place));
  return { key: `${place.kind} ${place.name}`, text: place.name, beside: place.kind, outside: null, go };
}

function Nowhere({ viewer, text }: { viewer: Viewer; text: string }) {
  const wanted = text.trim();
  const body = !viewer.keeps_bodies && wanted ? viewer.info.report.bodies.find(({ name }) => contains(name, wanted)) : undefined;
  if (body)
    return (
      <p class="place-note">
        <strong>“{body.name}” is a body, and this file keeps materials, not bodies. </strong>
        Meshed with <code>"label_by": "body"</code> in the scene, its name would lead there.
      </p>
    );
  return (
    <p class="place-note">
      {text.trim() !== "" && <strong>“{text.trim()}” is no place, and nothing here is called so. </strong>}
      Three numbers are x, y, z in {viewer.units}, or in a unit behind them. “cell 3, 4, 5” is a cell, “z = 2” moves along z alone, and the name of a
      material, a body or a part leads there.
    </p>
  );
}

export function PlaceField({ viewer }: { viewer: Viewer }) {
  const field = useRef<HTMLInputElement>(null);
  const text = useSignal("");
  const chosen = useSignal(0);
  const open = viewer.going.value;
  const names = useMemo(() => named_places(viewer), [viewer]);
  const goals = !open
    ? []
    : [
        ...spots_of(text.value, viewer.axes, viewer.info.units, viewer.cell.value).map((spot) => goal_of_spot(viewer, spot)),
        ...places_named(names, text.value, MOST).map((place) => goal_of_name(viewer, place)),
      ];
  // Before the next key comes.
  useLayoutEffect(() => {
    if (open) field.current!.focus();
  }, [open]);
  const go = (goal: Goal | undefined) => {
    if (!goal) return;
    goal.go();
    field.current!.blur();
  };
  const on_key = (event: KeyboardEvent) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) chosen.value = (chosen.value + step + goals.length) % Math.max(goals.length, 1);
    else if (event.key === "Enter") go(goals[chosen.value]);
    else if (event.key === "Escape") field.current!.blur();
    else return;
    event.preventDefault();
  };
  return (
    <div class={`place-field ${open ? "is-open" : ""}`} role="search">
      <IconButton class="place-open" icon="search" label="Go to a place" title="Go to a place (g)" onClick={() => (viewer.going.value = true)} />
      <div class="place-line">
        <Icon name="search" />
        <input
          ref={field}
          type="text"
          role="combobox"
          autocomplete="off"
          autocapitalize="off"
          spellcheck={false}
          placeholder="Go to a place (g)"
          aria-label="Go to a place: coordinates, a cell, or a name"
          aria-expanded={goals.length > 0}
          aria-controls="place-goals"
          aria-autocomplete="list"
          aria-activedescendant={goals.length > 0 ? `place-goal-${chosen.value}` : undefined}
          value={text.value}
          onInput={(e) => {
            text.value = e.currentTarget.value;
            chosen.value = 0;
          }}
          onFocus={(e) => {
            viewer.going.value = true;
            e.currentTarget.select();
          }}
          onBlur={() => (viewer.going.value = false)}
          onKeyDown={on_key}
        />
      </div>
      {open && (
        // A press here leaves the focus where it is, or the list would be gone before the click.
        <div class="place-list" onPointerDown={(e) => e.preventDefault()}>
          <ul id="place-goals" role="listbox" aria-label="Places" hidden={goals.length === 0}>
            {goals.map((goal, n) => (
              <li
                key={goal.key}
                id={`place-goal-${n}`}
                role="option"
                aria-selected={n === chosen.value}
                onPointerMove={() => (chosen.value = n)}
                onClick={() => go(goal)}
              >
                <bdi>{goal.text}</bdi>
                <span class="place-beside">{goal.beside}</span>
                {n === chosen.value && <kbd aria-hidden="true">Enter</kbd>}
                {goal.outside && <span class="place-outside">{goal.outside}</span>}
              </li>
            ))}
          </ul>
          {goals.length === 0 && <Nowhere viewer={viewer} text={text.value} />}
        </div>
      )}
    </div>
  );
}
