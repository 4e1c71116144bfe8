// Gestures and keys, in a dialog. The table is that of the views, so that it can't say anything else than they do.
import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { Icon } from "./icons";
import { bindings } from "./views/bindings";

export const help_open = signal(false);

const is_text_field = (target: EventTarget | null) => target instanceof HTMLElement && target.closest("input, textarea, select, [contenteditable]") !== null;

export function Help() {
  const dialog = useRef<HTMLDialogElement>(null);
  const shown = help_open.value;
  useEffect(() => {
    const on_key = (event: KeyboardEvent) => {
      if (event.key !== "h" || event.ctrlKey || event.metaKey || event.altKey || is_text_field(event.target)) return;
      help_open.value = !help_open.value;
    };
    addEventListener("keydown", on_key);
    return () => removeEventListener("keydown", on_key);
  }, []);
  useEffect(() => {
    if (shown && !dialog.current!.open) dialog.current!.showModal();
    else if (!shown) dialog.current!.close();
  }, [shown]);
  const close = () => (help_open.value = false);
  return (
    <dialog ref={dialog} class="dialog" aria-labelledby="help-title" onClose={close} onClick={(e) => e.target === dialog.current && close()}>
      <div class="dialog-body">
        <div class="dialog-head">
          <h2 id="help-title">Gestures and keys</h2>
          <button class="icon-button" aria-label="Close" onClick={close}>
            <Icon name="close" />
          </button>
        </div>
        <dl class="bindings">
          {bindings.map(({ keys, does }) => (
            <div key={keys}>
              <dt>{keys}</dt>
              <dd>{does}</dd>
            </div>
          ))}
        </dl>
      </div>
    </dialog>
  );
}
