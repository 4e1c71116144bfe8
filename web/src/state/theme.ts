// Light or dark. The system decides until somebody uses the switch. From then on this browser remembers the choice.
import { computed, effect, signal } from "@preact/signals";

type Theme = "light" | "dark";
const KEY = "teracell-theme";

// Storage may be forbidden. Then the choice lasts as long as the page.
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
    // Storage is forbidden.
  }
}

export function keep_theme(): void {
  system.addEventListener("change", () => (system_theme.value = system.matches ? "dark" : "light"));
  effect(() => {
    document.documentElement.dataset.theme = theme.value;
  });
}
