// The six steps of the first minute: what each points at, and what it says. They fit any grid, and were written for the sample.
import type { ViewName } from "./state/viewer";

export interface TourStep {
  readonly at: string; // a selector
  readonly view?: ViewName; // that must be in sight
  readonly panel?: "materials"; // likewise
  readonly head: string;
  readonly text: string;
}

export const TOUR: readonly TourStep[] = [
  {
    at: '[data-view="z"] .view-body',
    view: "z",
    head: "Slices",
    text: "Turn the wheel here to go through the slices; with a finger, drag the slider below. Three views cut the grid across z, x and y.",
  },
  {
    at: '[data-view="z"] .view-body',
    view: "z",
    head: "Near and far",
    text: "Ctrl and the wheel zoom at the pointer, or two fingers do, down to single cells. A drag moves the picture. Home shows the whole grid again.",
  },
  { at: ".dock", view: "z", head: "What is this?", text: "Click a cell. It stays here: where it is, what it is made of, and what lies along x, y and z through it." },
  {
    at: '[data-view="3d"] .view-overview',
    view: "3d",
    head: "In three dimensions",
    text: "Drag to turn, turn the wheel to go nearer. “Cut” opens the bodies at the crosshair. A double click brings all views to what you see.",
  },
  { at: "#side-panel", panel: "materials", head: "Materials", text: "Hide them, show one alone, give it another colour. The tabs have the report of the meshing, boxes and more." },
  {
    at: ".place-field",
    head: "Places and links",
    text: "Press g and write coordinates, a cell, or a name. The address of this page holds all that you see: send it to a colleague.",
  },
];
