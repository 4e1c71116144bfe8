// The page's icons: drawn on a square of 16 x 16, in the colour of the text.
import type { ComponentProps } from "preact";

const PATHS = {
  close: "M4 4l8 8M12 4l-8 8",
  eye: "M1.5 8S4 3.5 8 3.5 14.5 8 14.5 8 12 12.5 8 12.5 1.5 8 1.5 8zM8 10a2 2 0 1 0 0-4 2 2 0 0 0 0 4z",
  hidden: "M1.5 8S4 3.5 8 3.5 14.5 8 14.5 8 12 12.5 8 12.5 1.5 8 1.5 8zM3 13L13 3",
  solo: "M8 13.5a5.5 5.5 0 1 0 0-11 5.5 5.5 0 0 0 0 11zM8 9.5a1.5 1.5 0 1 0 0-3 1.5 1.5 0 0 0 0 3z",
  target: "M8 1.5v4M8 10.5v4M1.5 8h4M10.5 8h4M8 12a4 4 0 1 0 0-8 4 4 0 0 0 0 8z",
  search: "M7 11.5a4.5 4.5 0 1 0 0-9 4.5 4.5 0 0 0 0 9zM10.3 10.3l3.7 3.7",
  copy:
    "M5.5 5.5V3a.5.5 0 0 1 .5-.5h7a.5.5 0 0 1 .5.5v7a.5.5 0 0 1-.5.5h-2.5" +
    "M2.5 6a.5.5 0 0 1 .5-.5h7a.5.5 0 0 1 .5.5v7a.5.5 0 0 1-.5.5H3a.5.5 0 0 1-.5-.5z",
  done: "M3 8.5l3.5 3.5L13 5",
  sun: "M8 11a3 3 0 1 0 0-6 3 3 0 0 0 0 6zM8 1.5v1M8 13.5v1M1.5 8h1M13.5 8h1M3.4 3.4l.7.7M11.9 11.9l.7.7M3.4 12.6l.7-.7M11.9 4.1l.7-.7",
  moon: "M13.5 9.5A6 6 0 0 1 6.5 2.5a6 6 0 1 0 7 7z",
  help: "M6 6a2 2 0 1 1 2.7 1.9c-.5.2-.7.5-.7 1v.6M8 11.8v.2M8 14.5a6.5 6.5 0 1 0 0-13 6.5 6.5 0 0 0 0 13z",
  panel: "M2 3h12v10H2zM10 3v10",
  list: "M2.5 4h11M2.5 8h11M2.5 12h11",
  compare: "M2 3h12v10H2zM8 1.5v13M10 6l1.5 2-1.5 2M6 6L4.5 8 6 10",
  four: "M2 2.5h12v11H2zM8 2.5v11M2 8h12",
  open: "M2 13V3h4l1.5 2H14v8zM8 11.5V7.2M6.2 9L8 7.2 9.8 9",
  save: "M8 2v7.5M5 7l3 3 3-3M2.5 11.5v2h11v-2",
  link:
    "M6.5 9.5l3-3M7 4.5l1.2-1.2a2.5 2.5 0 0 1 3.6 0l.9.9a2.5 2.5 0 0 1 0 3.6L11.5 9" +
    "M9 11.5l-1.2 1.2a2.5 2.5 0 0 1-3.6 0l-.9-.9a2.5 2.5 0 0 1 0-3.6L4.5 7",
  away: "M6 3H3v10h10v-3M9 2.5h4.5V7M13.5 2.5L7.5 8.5",
  measure: "M1.5 10.5l9-9 4 4-9 9zM4 8l1.5 1.5M6.5 5.5L8 7M9 3l1.5 1.5",
  outline: "M2.5 13.5v-6h4v-5h7v11z",
  layers: "M8 2L1.5 5.5 8 9l6.5-3.5zM1.5 8.5L8 12l6.5-3.5M1.5 11.5L8 15l6.5-3.5",
  picture: "M2 2.5h12v11H2zM2 11l3.5-3.5L9 11l2-2 3 3M11 6.2v.1",
  pin: "M5.5 2.5h5M6.5 2.5v4L4 9h8L9.5 6.5v-4M8 9v5",
  box: "M2.5 2.5h11v11h-11zM1 2.5h3M2.5 1v3M12 13.5h3M13.5 12v3",
  reload: "M13 8a5 5 0 1 1-1.5-3.5L13 6M13 2.5V6H9.5",
  warning: "M8 2L1.5 13.5h13zM8 6.5v3.5M8 11.8v.2",
} as const;
export type IconName = keyof typeof PATHS;

export function Icon({ name }: { name: IconName }) {
  return (
    <svg class="icon" viewBox="0 0 16 16" width="16" height="16" aria-hidden="true">
      <path d={PATHS[name]} />
    </svg>
  );
}

// A button that is an icon. Its label is read aloud, and shown while the pointer rests on it, unless it has another title.
export function IconButton({ icon, label, class: more = "", ...props }: ComponentProps<"button"> & { icon: IconName; label: string; class?: string }) {
  return (
    <button type="button" title={label} aria-label={label} class={`icon-button ${more}`} {...props}>
      <Icon name={icon} />
    </button>
  );
}
