// Gestures and keys, in a dialog. The table is that of the views, so that it can't say anything else than they do.
import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { Icon } from "./icons";
import { bindings } from "./views/bindings";

export const help_open = signal(false);

export function Help() {
  const dialog = useRef<HTMLDialogElement>(null);
  const shown = help_open.value;
  useEffect(() => {
    if (shown && !dialog.current!.open) dialog.current!.showModal();
    else if (!shown) dialog.current!.close();
  }, [shown]);
  const close = () => (help_open.value = false);
  const on_key = (event: KeyboardEvent) => event.key === "h" && close();
  return (
    <dialog ref={dialog} class="dialog" aria-labelledby="help-title" onClose={close} onKeyDown={on_key} onClick={(e) => e.target === dialog.current && close()}>
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
        <p>
          <a href="NOTICE" target="_blank" rel="noreferrer">
            What others have written that is part of this page and its server, with the licences
          </a>
        </p>
      </div>
    </dialog>
  );
}
