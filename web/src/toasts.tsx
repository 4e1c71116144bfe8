// Shows the page's messages. Screen readers read them aloud as they come.
import { drop, toasts } from "./base/messages";
import { IconButton } from "./widgets/icons";

export function Toasts() {
  return (
    <div class="toasts" role="status" aria-live="polite">
      {toasts.value.map((t) => (
        <div class="toast" key={t.text}>
          <span class="toast-text">
            {t.text}
            {t.detail && (
              <span class="toast-detail" title={t.detail}>
                {t.detail}
              </span>
            )}
          </span>
          {t.times > 1 && <span class="faint">×{t.times}</span>}
          <IconButton icon="close" label="Dismiss this message" onClick={() => drop(t.text)} />
        </div>
      ))}
    </div>
  );
}
