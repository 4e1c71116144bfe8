// A button that copies text, and says that it did.
import { useState } from "preact/hooks";
import { say } from "../base/messages";
import { Icon } from "./icons";

// Pages that came over plain http from another machine may not use the clipboard. The older command still works there.
async function copy_text(text: string): Promise<void> {
  if (navigator.clipboard && isSecureContext) return navigator.clipboard.writeText(text);
  const area = document.createElement("textarea");
  area.value = text;
  area.className = "off-screen";
  document.body.append(area);
  area.select();
  const done = document.execCommand("copy");
  area.remove();
  if (!done) throw new Error("the browser refused");
}

interface CopyButtonProps {
  text: string | (() => string);
  what: string; // goes after "Copy"
  label?: string; // beside the icon
  disabled?: boolean;
  small?: boolean;
  done?: () => void; // is called when the text was copied
}

export function CopyButton({ text, what, label, disabled = false, small = false, done }: CopyButtonProps) {
  const [copied, set_copied] = useState(false);
  const copy = async () => {
    try {
      await copy_text(typeof text === "string" ? text : text());
      set_copied(true);
      done?.();
      setTimeout(() => set_copied(false), 1500);
    } catch {
      say("The browser did not allow copying. Select the text instead.");
    }
  };
  const name = `Copy ${what}`;
  return (
    <button class={`${label ? "button" : "icon-button"} ${small ? "small" : ""}`} title={name} aria-label={small || !label ? name : undefined} onClick={copy} disabled={disabled}>
      <Icon name={copied ? "done" : "copy"} />
      {label && <span>{copied && !small ? "Copied" : label}</span>}
    </button>
  );
}

// A line of code or a hash, which may be cut off on the screen, with the button that copies all of it.
export function CodeLine({ text, what, ...props }: { text: string; what: string; class: string }) {
  return (
    <span {...props}>
      <code title={text}>{text}</code>
      <CopyButton text={text} what={what} />
    </span>
  );
}
