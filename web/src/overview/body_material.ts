// How bodies are shaded: a soft key light that moves with the camera, sky and ground, and the baked openness. Inner sides, which show
// where a body is cut, are flat and a little darker. Colours are the materials' own; light is computed on linear values.
import { DoubleSide, GLSL3, RawShaderMaterial, Vector3 } from "three";
import type { MaterialLook } from "../materials";
import type { BodyMode } from "../viewer";


// Shared by all bodies: the crosshair, and on which side of it along each axis the camera is (0: nothing is cut away).
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
void main() {
  vec3 side = (place - cut_at) * cut_toward;
  if (min(side.x, min(side.y, side.z)) > 0.0) discard;
  vec3 n = normalize(normal);
  vec3 e = normalize(eye);
  bool inner = !gl_FrontFacing;
  if (inner) n = -n;
  float facing = clamp(dot(n, e), 0.0, 1.0);
  vec3 base = pow(color, vec3(2.2));
  vec3 l = normalize(vec3(-0.45, 0.62, 0.65));
  float key = max(dot(n, l), 0.0);
  float sky = 0.5 + 0.5 * dot(n, up);
  float ambient = mix(0.26, 0.62, sky) * mix(0.35, 1.0, open);
  float direct = 0.62 * key * mix(0.6, 1.0, open);
  vec3 h = normalize(l + e);
  float shine = 0.10 * pow(max(dot(n, h), 0.0), 40.0) * open;
  float rim = 0.10 * pow(1.0 - facing, 3.0) * open;
  vec3 lit = inner && glass < 0.5 ? base * 0.42 : base * (ambient + direct) + shine + rim;
  float alpha = opacity;
  if (glass > 0.5) alpha *= mix(0.10, 0.75, pow(1.0 - facing, 2.0));
  result = vec4(pow(lit, vec3(1.0 / 2.2)) * alpha, alpha);
}`;

export function make_body_material(cut: Cut, up: { value: Vector3 }): RawShaderMaterial {
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    side: DoubleSide,
    premultipliedAlpha: true,
    uniforms: { cut_at: cut.at, cut_toward: cut.toward, up, color: { value: new Vector3(0.5, 0.5, 0.5) }, opacity: { value: 1 }, glass: { value: 0 } },
  });
}

// Takes over colour and opacity. Whether the body is seen at all is the caller's.
export function set_look(material: RawShaderMaterial, look: MaterialLook, mode: BodyMode): void {
  const { color, opacity, glass } = material.uniforms as { color: { value: Vector3 }; opacity: { value: number }; glass: { value: number } };
  color.value.set(look.color[0] / 255, look.color[1] / 255, look.color[2] / 255);
  opacity.value = look.opacity;
  glass.value = mode === "glass" ? 1 : 0;
  const opaque = look.opacity >= 1 && mode !== "glass";
  material.transparent = !opaque;
  material.depthWrite = opaque;
}
