// Light or dark: as the system says until the switch is used; then as this browser remembers.
import { computed, effect, signal } from "@preact/signals";

type Theme = "light" | "dark";
const KEY = "teracell-theme";

// Storage may be forbidden: then the choice lasts as long as the page.
function remembered(): Theme | null {
  try {
    const text = localStorage.getItem(KEY);
    return text === "light" || text === "dark" ? text : null;
  } catch {
    return null;
  }
}

const system = matchMedia("(prefers-color-scheme: dark)");
const system_theme = signal<Theme>(system.matches ? "dark" : "light");
const chosen = signal<Theme | null>(remembered());

export const theme = computed<Theme>(() => chosen.value ?? system_theme.value);

export function switch_theme(): void {
  chosen.value = theme.value === "dark" ? "light" : "dark";
  try {
    localStorage.setItem(KEY, chosen.value);
  } catch {
    // nothing to remember it with
  }
}

export function keep_theme(): void {
  system.addEventListener("change", () => (system_theme.value = system.matches ? "dark" : "light"));
  effect(() => {
    document.documentElement.dataset.theme = theme.value;
  });
}
