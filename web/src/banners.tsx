// Messages about the page as a whole: the server does not answer, or the file behind the grid has changed.
import { useEffect, useState } from "preact/hooks";
import { clock, upper_first } from "./base/format";
import { reload, stale, unreadable, viewer } from "./page";
import { connection, next_try, try_now } from "./server/connection";
import { answerer, is_read_here } from "./server/transport";
import { Icon } from "./widgets/icons";

function Waiting() {
  const [, tick] = useState(0);
  useEffect(() => {
    const timer = setInterval(() => tick((n) => n + 1), 1000);
    return () => clearInterval(timer);
  }, []);
  const seconds = next_try.value === null ? 0 : Math.max(0, Math.ceil((next_try.value - Date.now()) / 1000));
  return <>{seconds > 0 ? `trying again in ${seconds} s` : "trying again"}</>;
}

export function Banners() {
  const lost = connection.value.state === "lost";
  const id = viewer.value?.info.id;
  const broken = unreadable.value.find((file) => file.id === id);
  return (
    <div class="banners" role="status" aria-live="polite">
      {lost && (
        <div class="banner bad">
          <Icon name="warning" />
          <span>
            {upper_first(answerer())} has not answered since {clock(connection.value.since)};{" "}
            <span aria-hidden="true">
              <Waiting />
            </span>
            . What is on screen stays.
          </span>
          <button class="button" onClick={() => void try_now()}>
            Try now
          </button>
        </div>
      )}
      {!lost && stale.value === "replaced" && (
        <div class="banner">
          <Icon name="reload" />
          <span>This grid was meshed again. You still see the earlier one.</span>
          <button class="button" onClick={reload}>
            Reload
          </button>
        </div>
      )}
      {!lost && stale.value === "gone" && (
        <div class="banner bad">
          <Icon name="warning" />
          <span>
            {is_read_here(id ?? "") ? `“${id}” can't be read any more` : `“${id}” is no longer served`}: {broken?.error ?? "its file is gone"}. What is on
            screen stays.
          </span>
        </div>
      )}
    </div>
  );
}
