// The dialog that lists gestures and keys, as the views declare them.
import { notice_address } from "./module/beside";
import { is_alone } from "./server/transport";
import { by_touch } from "./state/phone";
import type { Viewer } from "./state/viewer";
import { TourOffer } from "./tour";
import { type Binding, comparison_bindings, overview_bindings, slice_bindings } from "./views/bindings";
import { Dialog, DialogHead } from "./widgets/dialog";

function Bindings({ list }: { list: readonly Binding[] }) {
  const shown = by_touch ? list.flatMap(({ touch, does }) => (touch ? [{ keys: touch, does }] : [])) : list;
  return (
    <dl class="bindings">
      {shown.map(({ keys, does }) => (
        <div key={keys}>
          <dt>{keys}</dt>
          <dd>{does}</dd>
        </div>
      ))}
    </dl>
  );
}

export function Help({ viewer }: { viewer: Viewer }) {
  const { help } = viewer;
  return (
    <Dialog class="dialog" shown={help} heading="help-title" onKeyDown={(event) => ["h", "?"].includes(event.key) && (help.value = false)}>
      <div class="dialog-body">
        <DialogHead shown={help} heading="help-title" text="Gestures and keys" />
        {!viewer.compare.value && <TourOffer close={() => (help.value = false)} />}
        {!by_touch && <p class="note">Keys act on the view under the pointer, or on what the tab key has led to.</p>}
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
    </Dialog>
  );
}
