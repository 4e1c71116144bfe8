// Every gesture and key of the views, for the list of keys and the texts of help. keys.ts and gestures.ts do what stands here.
export interface Binding {
  readonly keys: string;
  readonly does: string;
}

export const bindings: readonly Binding[] = [
  { keys: "wheel", does: "next or previous slice" },
  { keys: "shift + wheel", does: "10 slices at once" },
  { keys: "alt + wheel", does: "to the next slices that look different: one cell of the level shown" },
  { keys: "ctrl + wheel, pinch", does: "zoom at the pointer" },
  { keys: "drag, one finger", does: "move the picture (with the middle button also while measuring)" },
  { keys: "click, tap", does: "put the crosshair on the cell and keep it in the read-out; again: let it go" },
  { keys: "right click, long press", does: "put the crosshair there, and all views look at it" },
  { keys: "double click", does: "one view alone, or all four" },
  { keys: ", .", does: "previous, next slice (with shift: 10)" },
  { keys: "p", does: "play the slices, pause" },
  { keys: "space", does: "the view under the pointer alone, or all four" },
  { keys: "← → ↑ ↓", does: "move the picture" },
  { keys: "+ −", does: "zoom" },
  { keys: "0", does: "the whole grid" },
  { keys: "c", does: "all views look at the crosshair" },
  { keys: "a", does: "crosshair and axes" },
  { keys: "b", does: "scale bar" },
  { keys: "l", does: "lines between cells" },
  { keys: "o", does: "outlines of materials" },
  { keys: "m", does: "measure a distance: drag once" },
  { keys: "x", does: "draw a box, for its statistics: drag once" },
  { keys: "h", does: "these keys" },
  { keys: "Escape", does: "back to looking; take away the measured line, the box, the pin" },
];
