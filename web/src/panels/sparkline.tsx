// A small curve of the last values, from 0; the newest is on the right.
export function Sparkline({ values, length, label }: { values: readonly number[]; length: number; label: string }) {
  const [width, height] = [104, 24];
  const most = Math.max(...values, 1e-12);
  const x = (n: number) => ((length - values.length + n) / (length - 1)) * width;
  const y = (v: number) => height - 1.5 - (v / most) * (height - 3);
  const line = values.map((v, n) => `${n ? "L" : "M"}${x(n).toFixed(1)} ${y(v).toFixed(1)}`).join("");
  const area = values.length > 1 ? `${line}L${width} ${height}L${x(0).toFixed(1)} ${height}Z` : "";
  return (
    <svg class="sparkline" viewBox={`0 0 ${width} ${height}`} width={width} height={height} role="img" aria-label={label}>
      <path class="spark-area" d={area} />
      <path class="spark-line" d={line} />
    </svg>
  );
}
