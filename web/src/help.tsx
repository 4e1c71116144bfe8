// The dialog that lists gestures and keys, as the views declare them.
import { useEffect, useRef } from "preact/hooks";
import { notice_address } from "./module/beside";
import { is_alone } from "./server/transport";
import type { Viewer } from "./state/viewer";
import { type Binding, comparison_bindings, overview_bindings, slice_bindings } from "./views/bindings";
import { Icon } from "./widgets/icons";

function Bindings({ list }: { list: readonly Binding[] }) {
  return (
    <dl class="bindings">
      {list.map(({ keys, does }) => (
        <div key={keys}>
          <dt>{keys}</dt>
          <dd>{does}</dd>
        </div>
      ))}
    </dl>
  );
}

export function Help({ viewer }: { viewer: Viewer }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const shown = viewer.help.value;
  useEffect(() => {
    if (shown && !dialog.current!.open) dialog.current!.showModal();
    else if (!shown) dialog.current!.close();
  }, [shown]);
  const close = () => (viewer.help.value = false);
  const on_key = (event: KeyboardEvent) => event.key === "h" && close();
  return (
    <dialog
      ref={dialog}
      class="dialog"
      aria-labelledby="help-title"
      onClose={close}
      onKeyDown={on_key}
      onClick={(e) => e.target === dialog.current && close()}
    >
      <div class="dialog-body">
        <div class="dialog-head">
          <h2 id="help-title">Gestures and keys</h2>
          <button class="icon-button" aria-label="Close" onClick={close}>
            <Icon name="close" />
          </button>
        </div>
        <h3>In a slice</h3>
        <Bindings list={slice_bindings} />
        <h3>In three dimensions</h3>
        <Bindings list={overview_bindings} />
        <h3>While two slices are compared</h3>
        <Bindings list={comparison_bindings} />
        <p>
          <a href={notice_address()} target="_blank" rel="noreferrer">
            Licences of the third-party software in this page{is_alone() ? "" : " and its server"}
          </a>
        </p>
      </div>
    </dialog>
  );
}
