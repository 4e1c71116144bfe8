// In place of a picture that can't be had, with the reason. If that is damage, the card of the grid says so.
import type { Signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { words_of } from "../base/messages";
import { is_damage } from "../server/api";

export function NoPicture({ error, damage }: { error: unknown; damage: Signal<string | null> }) {
  useEffect(() => {
    if (is_damage(error)) damage.value ??= words_of(error);
  }, [error]);
  return <span title={words_of(error)}>{is_damage(error) ? "damaged" : "no picture"}</span>;
}
