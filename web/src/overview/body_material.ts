// How bodies are shaded: by a soft key light that moves with the camera, by light from sky and ground, and by the
// openness that the worker has computed. Inner sides, which show where a body is cut, are flat and a little darker.
// Colours are the materials' own. Light is computed on their squares, which are near enough to linear values and cheap
// in software.
import { DoubleSide, FrontSide, GLSL3, RawShaderMaterial, Vector3 } from "three";
import type { MaterialLook } from "../base/materials";
import type { BodyMode } from "../state/viewer";

// Shared by all bodies: the crosshair, and for each axis the side of it on which the camera is (0: nothing is cut
// away).
export interface Cut {
  readonly at: { value: Vector3 };
  readonly toward: { value: Vector3 };
}
export const make_cut = (): Cut => ({ at: { value: new Vector3() }, toward: { value: new Vector3() } });

const vertexShader = `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
in vec3 position;
in vec4 shade;
out vec3 place, eye, normal;
out float open;
void main() {
  place = position;
  vec4 p = modelViewMatrix * vec4(position, 1.0);
  eye = -p.xyz;
  normal = mat3(modelViewMatrix) * shade.xyz;
  open = shade.w;
  gl_Position = projectionMatrix * p;
}`;

const fragmentShader = `
precision highp float;
uniform vec3 cut_at, cut_toward, color, up;
uniform float opacity, glass;
in vec3 place, eye, normal;
in float open;
out vec4 result;
const vec3 LIGHT = vec3(-0.448, 0.617, 0.647);
void main() {
  vec3 side = (place - cut_at) * cut_toward;
  if (min(side.x, min(side.y, side.z)) > 0.0) discard;
  vec3 n = normalize(normal);
  vec3 e = normalize(eye);
  float glancing = 1.0 - abs(dot(n, e));
  vec3 lit;
  if (gl_FrontFacing) {
    float key = max(dot(n, LIGHT), 0.0);
    float ambient = (0.52 + 0.22 * dot(n, up)) * (0.35 + 0.65 * open);
    float direct = key * (0.47 + 0.31 * open);
    float s = max(dot(n, normalize(LIGHT + e)), 0.0);
    s *= s; s *= s; s *= s; s *= s; s *= s;
    lit = color * (ambient + direct) + open * (0.1 * s + 0.1 * glancing * glancing * glancing);
  } else lit = color * 0.42;
  float alpha = opacity * (glass > 0.5 ? 0.12 + 0.73 * glancing * glancing : 1.0);
  result = vec4(sqrt(lit) * alpha, alpha);
}`;

export function make_body_material(cut: Cut, up: { value: Vector3 }): RawShaderMaterial {
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    premultipliedAlpha: true,
    uniforms: {
      cut_at: cut.at,
      cut_toward: cut.toward,
      up,
      color: { value: new Vector3(0.5, 0.5, 0.5) },
      opacity: { value: 1 },
      glass: { value: 0 },
    },
  });
}

// Takes over colour and opacity. The caller decides whether the body is shown at all.
export function set_look(material: RawShaderMaterial, look: MaterialLook, mode: BodyMode): void {
  const { color, opacity, glass } = material.uniforms as { color: { value: Vector3 }; opacity: { value: number }; glass: { value: number } };
  const [r, g, b] = look.color;
  color.value.set((r / 255) ** 2, (g / 255) ** 2, (b / 255) ** 2);
  opacity.value = look.opacity;
  glass.value = mode === "glass" ? 1 : 0;
  const opaque = look.opacity >= 1 && mode !== "glass";
  material.transparent = !opaque;
  const side = mode === "cut" ? DoubleSide : FrontSide; // inner sides show only where a body is cut
  if (material.side !== side) {
    material.side = side;
    material.needsUpdate = true;
  }
  material.depthWrite = opaque;
}
