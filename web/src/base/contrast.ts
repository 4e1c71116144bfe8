// Whether colours can be told from the ground that they are drawn on. Contrast is that of WCAG 2: 1 for equal colours, 21 for black on
// white.
type Color = readonly [number, number, number]; // sRGB, 0 to 255

function luminance(color: Color): number {
  const [r, g, b] = color.map((c) => (c <= 10 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4)) as [number, number, number];
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

export function contrast(a: Color, b: Color): number {
  const [x, y] = [luminance(a) + 0.05, luminance(b) + 0.05];
  return Math.max(x, y) / Math.min(x, y);
}

// The grounds of pictures, as in views.css: the usual one, and one for materials that the usual one swallows.
const GROUNDS = {
  light: { usual: [255, 255, 255], other: [201, 208, 218] },
  dark: { usual: [6, 8, 10], other: [74, 84, 98] },
} as const;
const LEAST = 1.3; // contrast

// Whether these colours are better seen on the other ground of a theme.
export function needs_other_ground(theme: keyof typeof GROUNDS, colors: readonly Color[]): boolean {
  const { usual, other } = GROUNDS[theme];
  const least = (ground: Color) => colors.reduce((worst, color) => Math.min(worst, contrast(color, ground)), Infinity); // there may be 10^6
  return least(usual) < LEAST && least(other) > least(usual);
}
