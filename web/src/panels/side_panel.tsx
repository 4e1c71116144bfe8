// The panel at the side (a sheet at the bottom on narrow screens): tabs, one of which is shown.
import { damaged_grids } from "../server/api";
import { is_alone } from "../server/transport";
import type { Panel, Viewer } from "../state/viewer";
import { IconButton } from "../widgets/icons";
import { use_sheet } from "../widgets/sheet";
import { BodiesPanel } from "./bodies";
import { BoxPanel } from "./box";
import { use_scrolled } from "./kept";
import { LeavesPanel } from "./leaves";
import { MaterialsPanel } from "./materials";
import { ReportPanel } from "./report";
import { DAMAGED, care_of } from "./report_words";
import { SharePanel } from "./share";
import { StatusPanel } from "./status";

interface Tab {
  readonly panel: Panel;
  readonly label: string;
  readonly Content: (props: { viewer: Viewer }) => preact.JSX.Element;
  readonly shown?: (viewer: Viewer) => boolean; // default: always
}

const TABS: readonly Tab[] = [
  { panel: "materials", label: "Materials", Content: MaterialsPanel },
  { panel: "bodies", label: "Bodies", Content: BodiesPanel, shown: (viewer) => viewer.keeps_bodies },
  { panel: "report", label: "Report", Content: ReportPanel },
  { panel: "box", label: "Box", Content: BoxPanel },
  { panel: "leaves", label: "Leaves", Content: LeavesPanel },
  { panel: "share", label: "Link", Content: SharePanel },
  { panel: "status", label: "Status", Content: StatusPanel, shown: () => !is_alone() },
];

export function SidePanel({ viewer }: { viewer: Viewer }) {
  const shown = viewer.panel.value;
  const tabs = TABS.filter((t) => t.shown?.(viewer) ?? true);
  const tab = tabs.find((t) => t.panel === shown);
  const care = damaged_grids.value.includes(viewer.info.id) ? DAMAGED : care_of(viewer.info);
  const { sheet, head } = use_sheet(shown !== null, (show) => (viewer.panel.value = show ? (viewer.panel.peek() ?? "materials") : null));
  const content = use_scrolled(viewer, shown);
  // As usual for tabs, the tab key stops once, and the arrow keys go from one tab to the next.
  const on_key = (event: KeyboardEvent) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const at = tabs.findIndex((t) => t.panel === shown);
    const next = tabs[(at + step + tabs.length) % tabs.length]!;
    viewer.panel.value = next.panel;
    document.getElementById(`tab-${next.panel}`)?.focus();
  };
  return (
    <aside class={`side-panel ${shown ? "" : "collapsed"}`} id="side-panel" aria-label="Side panel" ref={sheet}>
      <div class="tabs" {...head}>
        <div role="tablist" aria-label="Panels" onKeyDown={on_key}>
          {tabs.map(({ panel, label }, n) => (
            <button
              key={panel}
              role="tab"
              id={`tab-${panel}`}
              aria-selected={panel === shown}
              aria-controls="panel-content"
              tabIndex={panel === shown || (!shown && n === 0) ? 0 : -1}
              onFocus={(e) => e.currentTarget.scrollIntoView({ block: "nearest", inline: "nearest" })}
              onClick={() => (viewer.panel.value = panel)}
            >
              {label}
              {panel === "report" && care.level !== "fine" && <span class={`dot ${care.level}`} title={care.text} />}
            </button>
          ))}
        </div>
        <IconButton
          class="sheet-switch"
          icon={shown ? "close" : "panel"}
          label={shown ? "Hide the panel" : "Show the panel"}
          aria-expanded={shown !== null}
          onClick={() => (viewer.panel.value = shown ? null : "materials")}
        />
      </div>
      {tab && (
        <div class="panel-content" id="panel-content" role="tabpanel" aria-labelledby={`tab-${tab.panel}`} key={tab.panel} tabIndex={-1} ref={content}>
          <tab.Content viewer={viewer} />
        </div>
      )}
    </aside>
  );
}
