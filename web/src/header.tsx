// The header of the page: what is open, the layout of the views, and the switches of the page.
import type { ComponentChildren } from "preact";
import { about, bytes_text, noun, plural, product, sizes } from "./base/format";
import { grids, unreadable } from "./page";
import { PlaceField } from "./place_field";
import { toggle_comparison } from "./state/comparison";
import { switch_theme, theme } from "./state/theme";
import type { Layout, Viewer } from "./state/viewer";
import { Layers, Toolbar } from "./toolbar";
import { tour_offered } from "./tour";
import { Icon, IconButton } from "./widgets/icons";
import { type Segment, Segmented } from "./widgets/segmented";

// Nested cells, the mark of the page (also in index.html).
export function Mark() {
  return (
    <svg class="mark" viewBox="0 0 32 32" width="22" height="22" aria-hidden="true">
      <rect x="1" y="1" width="30" height="30" rx="6" class="mark-ground" />
      <path class="mark-large" d="M6 6h9v9H6z" />
      <path class="mark-middle" d="M17 6h9v9h-9zM6 17h9v9H6z" />
      <path class="mark-small" d="M17 17h4v4h-4zM22 22h4v4h-4zM22 17h4v4h-4zM17 22h4v4h-4z" />
    </svg>
  );
}

const layout = (value: Layout, label: string, text: ComponentChildren) => ({ value, text, class: `layout-${value}`, title: label, "aria-label": label });
const LAYOUTS: readonly Segment<Layout>[] = [
  layout("four", "All four views", <Icon name="four" />),
  layout("x", "Only the slice across x", "x"),
  layout("y", "Only the slice across y", "y"),
  layout("z", "Only the slice across z", "z"),
  layout("3d", "Only the overview in 3D", "3D"),
];

function Facts({ viewer }: { viewer: Viewer }) {
  const { cells } = viewer;
  const all = product(cells);
  return (
    <span class="facts" title={plural(all, "cell")}>
      <span class="fact-sizes">{sizes(cells)}</span>
      <span class="fact-cells">{about(all)} {noun(all, "cell")}</span>
      <span>{bytes_text(viewer.info.file.bytes)}</span>
      {viewer.has_shares && (
        <span>
          <button
            class="fact-shares"
            aria-pressed={viewer.show_shares.value}
            title="Of mixed cells the grid knows the share of each material. The read-out lists them; press here, or s, to see them as shades (zoom in to single cells)"
            onClick={() => (viewer.show_shares.value = !viewer.show_shares.peek())}
          >
            shares
          </button>
        </span>
      )}
    </span>
  );
}

export function Header({ viewer }: { viewer: Viewer | null }) {
  const several = (grids.value?.length ?? 0) + unreadable.value.length > 1;
  const dark = theme.value === "dark";
  return (
    <header class="header">
      <span class="home">
        <Mark />
        {!viewer && <span class="wordmark">teracell</span>}
      </span>
      {viewer && several && (
        <a class="icon-button" href="#" title="All grids" aria-label="All grids">
          <Icon name="list" />
        </a>
      )}
      {viewer && <h1 class="grid-name">{viewer.info.id}</h1>}
      {viewer && <Facts viewer={viewer} />}
      <span class="spacer" />
      {viewer && !viewer.compare.value && <PlaceField viewer={viewer} />}
      {viewer && !viewer.compare.value && <Toolbar viewer={viewer} />}
      {viewer && !viewer.compare.value && <Segmented label="Layout" value={viewer.layout.value} list={LAYOUTS} set={(to) => (viewer.layout.value = to)} />}
      <div class="header-buttons">
        {viewer?.compare.value && <Layers viewer={viewer} />}
        {viewer && (
          <button
            class="button compare-button"
            title="Compare with another grid, or another slice"
            aria-label="Compare"
            aria-pressed={viewer.compare.value !== null}
            onClick={() => toggle_comparison(viewer, grids.value ?? [])}
          >
            <Icon name="compare" />
            <span>Compare</span>
          </button>
        )}
        {viewer && (
          <IconButton
            icon="panel"
            label="Side panel"
            title={viewer.panel.value ? "Hide the panel" : "Show the panel"}
            aria-expanded={viewer.panel.value !== null}
            aria-controls="side-panel"
            onClick={() => (viewer.panel.value = viewer.panel.value ? null : "materials")}
          />
        )}
        <IconButton icon={dark ? "sun" : "moon"} label={dark ? "Use light colours" : "Use dark colours"} onClick={switch_theme} />
        {viewer && <IconButton class={`help-button ${tour_offered.value ? "is-new" : ""}`} icon="help" label="Help" title={tour_offered.value ? "Help (h), and a first minute" : "Help (h)"} onClick={() => (viewer.help.value = true)} />}
      </div>
    </header>
  );
}
