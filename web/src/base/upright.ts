// Which axis of a grid points up, as far as its inputs tell: y or z. The specification of glTF says that y does, and the report has the matrix by
// which the scene placed each body, so a scene that turns a file upright is seen to do so. Other formats leave it open (3MF says z): there it is z
// until somebody says otherwise.
import type { Report } from "./grid";

const IS_GLTF = /^(GLB|glTF)$/i;

// Where a matrix takes the y axis: to y, to z, or elsewhere.
function taken_y(matrix: readonly number[] | undefined): 1 | 2 | null {
  if (!matrix) return 1;
  const y = [1, 5, 9].map((at) => matrix[at] ?? 0) as [number, number, number];
  const length = Math.hypot(...y);
  return ([1, 2] as const).find((d) => y[d] > 0.99 * length) ?? null;
}

export function upright_axis(report: Report | undefined): 1 | 2 {
  const inputs = report?.inputs ?? [];
  const bodies = report?.scene?.bodies;
  const all_y = inputs.length > 0 && inputs.every(({ format }, n) => IS_GLTF.test(format) && taken_y(bodies?.[n]?.matrix) === 1);
  return all_y ? 1 : 2;
}
