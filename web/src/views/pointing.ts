// Whether the pointer is over a view and was used last. The keyboard takes the keys back by moving the focus: somebody who goes to a
// slider with the tab key moves the slider, whatever the pointer lies on; somebody who has clicked a slider and points at a view moves the
// view.

export interface Pointing {
  readonly at_a_view: boolean;
  stop(): void;
}

export function watch_pointing(): Pointing {
  const listening = new AbortController();
  const options = { capture: true, signal: listening.signal } as const;
  let at_a_view = false;
  let pressed = false; // a focus that comes meanwhile is the pointer's
  const look = (under: EventTarget | null) => (at_a_view = under instanceof Element && under.closest(".view-panel") !== null);
  // Where something comes or goes under a pointer at rest, browsers report a movement as well.
  let last = { x: Number.NaN, y: Number.NaN };
  document.addEventListener(
    "pointermove",
    ({ target, screenX: x, screenY: y }) => {
      if (x !== last.x || y !== last.y) look(target);
      last = { x, y };
    },
    options,
  );
  document.addEventListener(
    "pointerdown",
    (event) => {
      pressed = true;
      look(event.target);
    },
    options,
  );
  // What was dragged has had all events so far, wherever the pointer went.
  const release = (event: PointerEvent) => {
    pressed = false;
    last = { x: event.screenX, y: event.screenY };
    look(document.elementFromPoint(event.clientX, event.clientY));
  };
  for (const type of ["pointerup", "pointercancel"] as const) document.addEventListener(type, release, options);
  document.addEventListener("focusin", () => (at_a_view &&= pressed), options);
  return {
    get at_a_view() {
      return at_a_view;
    },
    stop: () => listening.abort(),
  };
}
