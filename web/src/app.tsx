// The frame of the page: what is open, what is wrong, and what floats above the rest.
import { effect } from "@preact/signals";
import { render } from "preact";
import { Banners } from "./banners";
import { ComparisonPage } from "./compare/comparison_page";
import { Dock } from "./dock/dock";
import { FigureDialog } from "./figures/dialog";
import { Header } from "./header";
import { Help } from "./help";
import { grids, opening, start_page, trouble, unreadable, viewer } from "./page";
import { can_read_files, dragged, watch_drops } from "./module/own_grids";
import { SidePanel } from "./panels/side_panel";
import { token_wanted } from "./server/api";
import { watch_network } from "./server/connection";
import { StartPage } from "./start/start_page";
import { keep_theme } from "./state/theme";
import { Toasts } from "./toasts";
import { Tour } from "./tour";
import { TokenForm } from "./token_form";
import { Views } from "./views/views";
import "./style.css";
import "./overview/overview.css"; // not with its module: the browser asks for the style sheet of a module only once, also in vain

keep_theme();

const SOON = 200; // milliseconds

// Resolves when it is known what there is to see, or when that takes longer than SOON.
const known = (): Promise<void> =>
  new Promise((done) => {
    setTimeout(done, SOON);
    effect(() => {
      if (viewer.value || trouble.value || token_wanted.value || (grids.value && !opening.value)) done();
    });
  });

// A grid that comes soon is what is shown first, without another page before it.
export async function show(element: HTMLElement): Promise<void> {
  watch_drops();
  watch_network();
  void start_page();
  await known();
  element.replaceChildren(); // what was said in case that this does not start
  render(<App />, element);
}

function DropHere() {
  return (
    <div class="drop-here">
      <p>
        {can_read_files ? "Drop .tcell files to open them, or a surface (STL, STEP …) to see how it becomes a grid." : "Drop a surface (STL, STEP …) to see how it becomes a grid."}{" "}
        Nothing is uploaded.
      </p>
    </div>
  );
}

function App() {
  const open = viewer.value;
  if (token_wanted.value) return <TokenForm />;
  return (
    <>
      <div class="page" key={open ? `${open.info.id} ${open.info.file.hash}` : "none"}>
        <Header viewer={open} />
        <Banners />
        {open?.compare.value ? (
          <ComparisonPage viewer={open} grids={grids.value} />
        ) : open ? (
          <div class="workspace">
            <main class="views-area" aria-label="Slices">
              <Views viewer={open} />
            </main>
            <Dock viewer={open} />
            <SidePanel viewer={open} />
          </div>
        ) : (
          <StartPage grids={grids.value} unreadable={unreadable.value} waiting={opening.value} trouble={trouble.value} />
        )}
      </div>
      {open && <Help viewer={open} />}
      {open && <Tour viewer={open} />}
      {open && <FigureDialog viewer={open} />}
      <Toasts />
      {dragged.value && <DropHere />}
    </>
  );
}
