// Every gesture and key of the views, as the help dialog lists them. keys.ts and gestures.ts do what is listed here, and in three dimensions
// overview/gestures.ts.
export interface Binding {
  readonly keys: string;
  readonly touch?: string; // what fingers do instead
  readonly does: string;
}

export const slice_bindings: readonly Binding[] = [
  { keys: "wheel", touch: "arrows below", does: "next or previous slice" },
  { keys: "shift + wheel", does: "10 slices at once" },
  { keys: "alt + wheel", does: "next slice that looks different: one cell of the level shown" },
  { keys: "ctrl + wheel, pinch", touch: "pinch", does: "zoom at that place" },
  { keys: "drag, one finger", touch: "one finger", does: "move the picture; while measuring, use the middle button or two fingers" },
  { keys: "click, tap", touch: "tap", does: "put the crosshair on the cell and pin it; a second time unpins it" },
  { keys: "right click, long press", touch: "long press", does: "put the crosshair there and centre all views on it" },
  { keys: "double click", does: "show this view alone, or all four" },
  { keys: ", .", does: "previous or next slice; with shift, 10 slices" },
  { keys: "p", does: "play the slices, or pause" },
  { keys: "space", does: "show the view under the pointer alone, or all four" },
  { keys: "← → ↑ ↓", does: "move the picture" },
  { keys: "shift + ← → ↑ ↓", does: "move the crosshair in the plane of the slice: one cell of the level shown" },
  { keys: "+ −", does: "zoom: twice or half as large" },
  { keys: "1", does: "show single cells: those around the crosshair" },
  { keys: "Home, 0", does: "show the whole grid" },
  { keys: "c", does: "centre all views on the crosshair" },
  { keys: "a", does: "show or hide the crosshair and the axes" },
  { keys: "b", does: "show or hide the scale bar" },
  { keys: "l", does: "show or hide the lines between cells, and on graded axes the smallest one" },
  { keys: "e", does: "show or hide the outlines of materials" },
  { keys: "o", does: "slice along a plane of any direction, in place of this view, or go back; there shift with a drag or an arrow turns the plane, and the wheel moves it" },
  { keys: "s", does: "show mixed cells by their shares, where the grid has them, or as cells of one material" },
  { keys: "r", does: "show or hide the leaves of the refined grid, in place of the lines between cells" },
  { keys: "m", does: "measure a distance with one drag; its ends snap to boundaries, with alt they do not" },
  { keys: "t, shift + click", does: "measure how thick the material of the cell is" },
  { keys: "Enter", does: "while measuring: begin or end the line at the crosshair" },
  { keys: "x", does: "draw a box with one drag, for its statistics; its handles move it" },
  { keys: "f", does: "save a figure for print: PNG or SVG" },
  { keys: "g", does: "go to a place: coordinates, a cell, or the name of a body, a part or a material" },
  { keys: "h ?", does: "show these keys" },
  { keys: "Escape", does: "put the tool away; show all again; let go of the chosen line; remove the box or the pin" },
  { keys: "Delete, Backspace", does: "remove the chosen line" },
];

export const overview_bindings: readonly Binding[] = [
  { keys: "drag, one finger", touch: "one finger", does: "turn around what is in the middle" },
  { keys: "right drag, shift + drag, two fingers", touch: "two fingers", does: "move the picture" },
  { keys: "wheel, pinch", touch: "pinch", does: "move towards that place, or away from it" },
  { keys: "pointer at rest", does: "name the body, the material and the cell" },
  { keys: "click, tap", touch: "tap", does: "pin the cell; while measuring (m), begin or end a line on the surface" },
  { keys: "shift + click", does: "measure how thick the material is there, along the normal of its surface" },
  { keys: "double click", touch: "double tap", does: "put the crosshair on the cell and go there" },
  { keys: "← → ↑ ↓", does: "turn" },
  { keys: "+ −", does: "move closer or farther away" },
  { keys: "Home", does: "show everything" },
];

// What differs from a single slice.
export const comparison_bindings: readonly Binding[] = [
  { keys: "pointer", does: "a ring shows the same place in the other picture, and the line below names the materials in both" },
  { keys: "drag, zoom, click", touch: "drag, pinch, tap", does: "act on both pictures; slices move together, or apart without “Move together”" },
  { keys: "← → on the handle", does: "move the handle of a wipe; Home, End, Page up and Page down as well" },
];
