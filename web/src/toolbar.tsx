// The tools that keys have as well, as buttons in the header: measure, draw a box, outline materials, save a figure, and
// what is drawn over the cells.
import type { Signal } from "@preact/signals";
import { useState } from "preact/hooks";
import type { Viewer } from "./state/viewer";
import { choose_tool } from "./views/actions";
import { Icon, type IconName } from "./widgets/icons";

interface ToolProps {
  icon: IconName;
  label: string;
  shortcut: string;
  pressed: boolean;
  click: () => void;
}

function Tool({ icon, label, shortcut, pressed, click }: ToolProps) {
  return (
    <button title={`${label} (${shortcut})`} aria-label={label} aria-pressed={pressed} onClick={click}>
      <Icon name={icon} />
    </button>
  );
}

function Layer({ label, shortcut, shown }: { label: string; shortcut: string; shown: Signal<boolean> }) {
  return (
    <label>
      <input type="checkbox" checked={shown.value} onChange={(e) => (shown.value = e.currentTarget.checked)} />
      {label}
      <kbd aria-hidden="true">{shortcut}</kbd>
    </label>
  );
}

// What is drawn over the cells. It closes when the focus leaves it, or by Escape.
export function Layers({ viewer }: { viewer: Viewer }) {
  const [open, set_open] = useState(false);
  return (
    <div
      class="layers"
      onFocusOut={(e) => !e.currentTarget.contains(e.relatedTarget as Node | null) && set_open(false)}
      onKeyDown={(e) => {
        if (e.key !== "Escape" || !open) return;
        e.preventDefault();
        set_open(false);
        e.currentTarget.querySelector("button")!.focus();
      }}
    >
      <button class="layers-button" title="Layers over the cells" aria-label="Layers over the cells" aria-expanded={open} onClick={() => set_open(!open)}>
        <Icon name="layers" />
      </button>
      {open && (
        <div class="layers-list" role="group" aria-label="Layers" tabIndex={-1}>
          <Layer label="Crosshair and axes" shortcut="a" shown={viewer.show_axes} />
          <Layer label="Scale bar" shortcut="b" shown={viewer.show_scale} />
          <Layer label="Lines between cells" shortcut="l" shown={viewer.show_lines} />
          <Layer label="Outlines of materials" shortcut="e" shown={viewer.show_outline} />
          <Layer label="Leaves of the refined grid" shortcut="r" shown={viewer.show_leaves} />
          {viewer.has_shares && <Layer label="Mixed cells by their shares" shortcut="s" shown={viewer.show_shares} />}
        </div>
      )}
    </div>
  );
}

export function Toolbar({ viewer }: { viewer: Viewer }) {
  const { tool, show_outline } = viewer;
  const take = (name: "measure" | "box") => choose_tool(viewer, name);
  return (
    <div class="segmented toolbar" role="group" aria-label="Tools">
      <Tool icon="measure" label="Measure a distance" shortcut="m" pressed={tool.value === "measure"} click={() => take("measure")} />
      <Tool icon="box" label="Draw a box" shortcut="x" pressed={tool.value === "box"} click={() => take("box")} />
      <Tool
        icon="outline"
        label="Outline materials"
        shortcut="e"
        pressed={show_outline.value}
        click={() => (show_outline.value = !show_outline.value)}
      />
      <button title="Save a figure (f)" aria-label="Save a figure" aria-haspopup="dialog" onClick={() => (viewer.figure.value = true)}>
        <Icon name="picture" />
      </button>
      <Layers viewer={viewer} />
    </div>
  );
}
