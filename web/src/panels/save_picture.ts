// For buttons that save the views as a picture: whether it is being drawn, and what begins it.
import { useState } from "preact/hooks";
import { say, words_of } from "../base/messages";
import type { Viewer } from "../state/viewer";
import { save_picture } from "../views/picture";

export function use_save_picture(viewer: Viewer): { busy: boolean; save: () => void } {
  const [busy, set_busy] = useState(false);
  const draw = async () => {
    set_busy(true);
    try {
      await save_picture(viewer);
    } catch (error) {
      say(`The picture could not be made: ${words_of(error)}`);
    }
    set_busy(false);
  };
  return { busy, save: () => void draw() };
}
