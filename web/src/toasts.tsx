// Shows the page's messages, all of each. Screen readers read them aloud as they come. They stay while the pointer or the focus is on them.
import { type Toast, drop, hold, release, toasts } from "./base/messages";
import { CodeLine } from "./widgets/copy";
import { IconButton } from "./widgets/icons";

function Message({ text, detail, command, times }: Toast) {
  const keep = () => hold(text);
  const let_go = () => release(text);
  return (
    <div class="toast" onPointerEnter={keep} onPointerLeave={let_go} onFocusIn={keep} onFocusOut={let_go}>
      <div class="toast-text">
        <p>
          {text} {times > 1 && <span class="faint">×{times}</span>}
        </p>
        {detail && <p class="toast-detail">{detail}</p>}
        {command && <CodeLine class="code-line" text={command} what="the command" />}
      </div>
      <IconButton icon="close" label="Dismiss this message" onClick={() => drop(text)} />
    </div>
  );
}

export function Toasts() {
  return (
    <div class="toasts" role="status" aria-live="polite">
      {toasts.value.map((toast) => (
        <Message key={toast.text} {...toast} />
      ))}
    </div>
  );
}
