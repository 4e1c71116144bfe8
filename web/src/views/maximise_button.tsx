// The button of a view that shows it alone, or all four again. The tab key passes it by: the view itself takes its key.
export function MaximiseButton({ what, alone, toggle }: { what: string; alone: boolean; toggle: () => void }) {
  return (
    <button
      class="view-maximise"
      tabIndex={-1}
      aria-label={alone ? "All four views" : `${what} alone`}
      title={alone ? "All four views (space)" : "This view alone (space)"}
      onClick={toggle}
    >
      <svg viewBox="0 0 16 16" width="14" height="14" aria-hidden="true" fill="none" stroke="currentColor" stroke-width="1.6">
        <path d={alone ? "M6.5 2v4.5H2M9.5 14V9.5H14" : "M9.5 2.5h4v4M6.5 13.5h-4v-4"} />
      </svg>
    </button>
  );
}
