// Writes the words and knobs that are elements of the page into a canvas of the same size, so that a saved picture has them too.
export function write_words(root: HTMLElement, ink: HTMLCanvasElement): void {
  const frame = root.getBoundingClientRect();
  const ratio = 2;
  ink.width = Math.round(frame.width * ratio);
  ink.height = Math.round(frame.height * ratio);
  const context = ink.getContext("2d")!;
  context.scale(ratio, ratio);
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (const word of root.querySelectorAll<HTMLElement>(".overview-number:not([hidden]), .overview-knob:not([hidden])")) {
    const box = word.getBoundingClientRect();
    const style = getComputedStyle(word);
    const [x, y] = [box.left - frame.left + box.width / 2, box.top - frame.top + box.height / 2];
    if (word.classList.contains("overview-knob")) {
      context.fillStyle = style.backgroundColor;
      context.beginPath();
      context.arc(x, y, box.width / 2, 0, 2 * Math.PI);
      context.fill();
    }
    context.fillStyle = style.color;
    context.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
    context.fillText(word.textContent, x, y);
  }
}
