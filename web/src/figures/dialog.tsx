// The dialog that saves a figure for a paper, with a preview. The last choices stay for the next time.
import { signal } from "@preact/signals";
import type { ComponentProps } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { save_blob } from "../base/download";
import { bytes_text, grouped } from "../base/format";
import { words_of } from "../base/messages";
import { use_settled } from "../server/answer";
import type { Viewer } from "../state/viewer";
import { Dialog, DialogHead } from "../widgets/dialog";
import { Icon } from "../widgets/icons";
import { type Option, Select } from "../widgets/select";
import { make_figure, name_of, preview_of, standard_title } from "./figure";
import { type FigureOptions, STANDARD, type Subject, UNITS, fault_of, has_space, pixels_of } from "./options";
import "./figures.css";

const PREVIEW = 460; // CSS pixels
const SETTLED = 250; // milliseconds

const choices = signal<FigureOptions>(STANDARD);
let typed_for: Viewer | null = null; // the grid that the title was typed for; a title from the view is of what was seen then, and doesn't stay

const SUBJECTS: readonly Option<Subject>[] = [
  { value: "z", label: "slice across z" },
  { value: "y", label: "slice across y" },
  { value: "x", label: "slice across x" },
  { value: "3d", label: "three dimensions" },
  { value: "four", label: "all four views on one sheet" },
  { value: "sides", label: "three dimensions, from four sides" },
];
const CROPS: readonly Option<FigureOptions["crop"]>[] = [
  { value: "content", label: "to what isn't clear" },
  { value: "screen", label: "to what the view shows" },
  { value: "whole", label: "nothing" },
];
const GROUNDS: readonly Option<FigureOptions["ground"]>[] = [
  { value: "white", label: "white" },
  { value: "clear", label: "clear" },
  { value: "black", label: "black" },
];

function Choice<T extends string>(props: ComponentProps<typeof Select<T>>) {
  return (
    <label class="figure-choice">
      {props.label}
      <Select {...props} />
    </label>
  );
}

function Switch({ label, on, set, disabled = false }: { label: string; on: boolean; set: (on: boolean) => void; disabled?: boolean }) {
  return (
    <label class="check">
      <input type="checkbox" checked={on} disabled={disabled} onChange={(e) => set(e.currentTarget.checked)} />
      {label}
    </label>
  );
}

function NumberField({ label, value, set }: { label: string; value: number; set: (value: number) => void }) {
  return (
    <label class="figure-choice">
      {label}
      <input class="text-input" type="number" aria-label={label} min={1} step="any" value={value} onInput={(e) => set(Number(e.currentTarget.value))} />
    </label>
  );
}

// The preview, and how large the figure will be.
function Preview({ viewer, options }: { viewer: Viewer; options: FigureOptions }) {
  const host = useRef<HTMLDivElement>(null);
  const [said, say] = useState("Drawing …");
  const settled = use_settled(options, SETTLED);
  const fault = fault_of(options);
  useEffect(() => {
    if (fault_of(settled)) return;
    const abort = new AbortController();
    const pixels = Math.min(pixels_of(settled), PREVIEW * devicePixelRatio);
    say("Drawing …");
    preview_of(viewer, settled, pixels, abort.signal).then(
      ({ canvas, height }) => {
        if (abort.signal.aborted) return;
        canvas.setAttribute("role", "img");
        canvas.setAttribute("aria-label", "Preview of the figure");
        host.current!.replaceChildren(canvas);
        say(settled.format === "svg" ? "" : `${grouped(pixels_of(settled))} × ${grouped(Math.round(height))} pixels`);
      },
      (error: unknown) => abort.signal.aborted || say(`There is no preview: ${words_of(error)}.`),
    );
    return () => abort.abort();
  }, [viewer, settled]);
  return (
    <div class="figure-preview">
      <div class={`figure-paper ${options.ground}`} ref={host} />
      <p class="note" role="status">
        {fault ?? said}
      </p>
    </div>
  );
}

function Content({ viewer }: { viewer: Viewer }) {
  const options = choices.value;
  const [state, set_state] = useState<{ text: string; busy: boolean }>({ text: "", busy: false });
  const set = (what: Partial<FigureOptions>) => {
    const now = { ...options, ...what };
    choices.value = typed_for || now.title === "" ? now : { ...now, title: standard_title(viewer, now) }; // a title from the view follows what is chosen
    if (!state.busy) set_state({ text: "", busy: false }); // what was said was about another figure
  };
  const set_title = (title: string, by: Viewer | null) => {
    typed_for = by;
    set({ title });
  };
  const abort = useRef(new AbortController());
  useEffect(() => {
    const layout = viewer.layout.peek();
    choices.value = { ...choices.peek(), ...(typed_for !== viewer && { title: "" }), ...(layout !== "four" && { subject: layout }), ...(layout === "3d" && { format: "png" }) };
    return () => abort.current.abort();
  }, []);
  const is_slice = !has_space(options.subject);
  const has_slices = options.subject === "four" || is_slice;
  const fault = fault_of(options);
  const save = async (event: Event) => {
    event.preventDefault();
    if (state.busy) return; // a disabled button would lose the focus, and with it the key that closes
    set_state({ text: "Drawing …", busy: true });
    try {
      const figure = await make_figure(viewer, options, abort.current.signal);
      save_blob(figure.blob, name_of(viewer, options));
      set_state({ text: `Saved ${name_of(viewer, options)}, ${bytes_text(figure.blob.size)}. ${figure.note}`, busy: false });
    } catch (error) {
      if (!abort.current.signal.aborted) set_state({ text: `The figure can't be made: ${words_of(error)}.`, busy: false });
    }
  };
  return (
    <form class="dialog-body figure" onSubmit={save}>
      <DialogHead shown={viewer.figure} heading="figure-title" text="Save a figure" />
      <div class="figure-parts">
        <Preview viewer={viewer} options={options} />
        <div class="figure-choices">
          <Choice label="What" value={options.subject} list={SUBJECTS} set={(subject) => set({ subject, ...(has_space(subject) && { format: "png" }) })} />
          <Choice
            label="Format"
            value={options.format}
            list={is_slice ? [{ value: "png", label: "PNG" }, { value: "svg", label: "SVG" }] : [{ value: "png", label: "PNG" }]}
            set={(format) => set({ format })}
          />
          <div class="figure-row">
            <NumberField label="Width" value={options.width} set={(width) => set({ width })} />
            <Choice label="Unit" value={options.unit} list={UNITS.map((unit) => ({ value: unit, label: unit === "px" ? "pixels" : unit }))} set={(unit) => set({ unit })} />
            <NumberField label="Dots per inch" value={options.dpi} set={(dpi) => set({ dpi })} />
          </div>
          <Choice label="Crop" value={options.crop} list={CROPS} set={(crop) => set({ crop })} />
          <Choice label="Ground" value={options.ground} list={GROUNDS} set={(ground) => set({ ground })} />
          <label class="figure-choice">
            Title
            <input
              class="text-input"
              type="text"
              aria-label="Title"
              value={options.title}
              placeholder="none"
              onInput={(e) => set_title(e.currentTarget.value, viewer)}
            />
          </label>
          <button type="button" class="button small" onClick={() => set_title(standard_title(viewer, options), null)}>
            Title from the view
          </button>
          <Switch label="Axes with coordinates" on={options.axes} set={(axes) => set({ axes })} />
          <Switch label="Lines between cells" on={options.lines && has_slices} disabled={!has_slices} set={(lines) => set({ lines })} />
          <Switch
            label={options.subject === "3d" ? "Scale bar: none is true in perspective" : "Scale bar"}
            on={options.bar && options.subject !== "3d"}
            disabled={options.subject === "3d"}
            set={(bar) => set({ bar })}
          />
          <Switch label="Legend of the materials that are seen" on={options.legend} set={(legend) => set({ legend })} />
        </div>
      </div>
      <div class="toolbar">
        <button class="button primary" type="submit" autofocus disabled={fault !== null} aria-disabled={state.busy}>
          <Icon name="save" /> Save
        </button>
        <p class="note" role="status">
          {state.text}
        </p>
      </div>
    </form>
  );
}

export function FigureDialog({ viewer }: { viewer: Viewer }) {
  return (
    <Dialog class="dialog wide" shown={viewer.figure} heading="figure-title">
      <Content viewer={viewer} />
    </Dialog>
  );
}
