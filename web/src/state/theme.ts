// Light or dark. The system decides until somebody uses the switch. From then on this browser remembers the choice.
import { computed, effect, signal } from "@preact/signals";
import { if_allowed } from "../base/storage";

type Theme = "light" | "dark";
const KEY = "teracell-theme";

const system = matchMedia("(prefers-color-scheme: dark)");
const system_theme = signal<Theme>(system.matches ? "dark" : "light");
const kept = if_allowed(() => localStorage.getItem(KEY));
const chosen = signal<Theme | null>(kept === "light" || kept === "dark" ? kept : null);

export const theme = computed<Theme>(() => chosen.value ?? system_theme.value);

export function switch_theme(): void {
  const other = theme.value === "dark" ? "light" : "dark";
  chosen.value = other;
  if_allowed(() => localStorage.setItem(KEY, other));
}

export function keep_theme(): void {
  system.addEventListener("change", () => (system_theme.value = system.matches ? "dark" : "light"));
  effect(() => {
    document.documentElement.dataset.theme = theme.value;
  });
}

// Calls when the page's colours may have changed. Returns a function that ends this.
export function on_theme(call: () => void): () => void {
  const observer = new MutationObserver(call);
  observer.observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme", "data-ground"] });
  return () => observer.disconnect();
}
