// What the browser remembers of the page. Storage may be forbidden, as in frames of other sites: then it remembers nothing.
type Kind = "localStorage" | "sessionStorage"; // for ever, or for this tab

export function remembered(kind: Kind, key: string): string | null {
  try {
    return window[kind].getItem(key);
  } catch {
    return null;
  }
}

export function remember(kind: Kind, key: string, text: string): void {
  try {
    window[kind].setItem(key, text);
  } catch {
    // Storage is forbidden.
  }
}
