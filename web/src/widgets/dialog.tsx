// A dialog in front of the page. It closes by its button, by Escape, and by a click beside it.
import type { Signal } from "@preact/signals";
import type { ComponentProps } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { IconButton } from "./icons";

// `heading`: the id of its heading.
export function Dialog({ shown, heading, children, ...props }: ComponentProps<"dialog"> & { shown: Signal<boolean>; heading: string }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const open = shown.value;
  useEffect(() => {
    if (!open) dialog.current!.close();
    else if (!dialog.current!.open) {
      dialog.current!.showModal();
      for (const part of [dialog.current!, ...dialog.current!.children]) part.scrollTop = 0; // whatever has the focus
    }
  }, [open]);
  const close = () => (shown.value = false);
  return (
    <dialog ref={dialog} aria-labelledby={heading} onClose={close} onClick={(e) => e.target === dialog.current && close()} {...props}>
      {open && children}
    </dialog>
  );
}

export function DialogHead({ shown, heading, text }: { shown: Signal<boolean>; heading: string; text: string }) {
  return (
    <div class="dialog-head">
      <h2 id={heading}>{text}</h2>
      <IconButton icon="close" label="Close" onClick={() => (shown.value = false)} />
    </div>
  );
}
