// A picture of what is seen from somewhere, and how it is drawn: as it is, or from somewhere else, as points in space.
import {
  AlwaysDepth, BufferGeometry, DataTexture, FloatType, GLSL3, type Matrix4, Mesh, NearestFilter, NoBlending, Points, RawShaderMaterial, RedFormat,
  type ShaderMaterialParameters, Vector2, Vector3,
} from "three";
import type { Colored } from "./sight/compose";
import { type Orbit, add, basis, dot, eye_of, reach } from "./space/camera";
import type { Vec3 } from "./space/space";

// Pixels that have not come yet are NOT_YET far away.
export const NOT_YET = -1;

export interface Frame extends Colored {
  readonly orbit: Orbit;
}

export function empty_frame(orbit: Orbit, width: number, height: number): Frame {
  const n = width * height;
  return { orbit, width, height, pixels: new Uint8Array(4 * n), far: new Float32Array(n).fill(NOT_YET), label: new Uint32Array(n) };
}

export function put_part(frame: Frame, part: Colored, x0: number, y0: number): void {
  for (let y = 0; y < part.height; ++y) {
    const [from, to] = [y * part.width, (y0 + y) * frame.width + x0];
    frame.pixels.set(part.pixels.subarray(4 * from, 4 * (from + part.width)), 4 * to);
    frame.far.set(part.far.subarray(from, from + part.width), to);
    frame.label.set(part.label.subarray(from, from + part.width), to);
  }
}

// The point that a pixel shows; null where nothing is seen.
export function point_at(frame: Frame, x: number, y: number): Vec3 | null {
  const far = frame.far[y * frame.width + x];
  if (far === undefined || !(far > 0)) return null;
  const { right, up, back } = basis(frame.orbit);
  const step = (2 * reach(frame.width / frame.height).y) / frame.height;
  const along = add(add(add([0, 0, 0], back, -1), right, (x + 0.5 - frame.width / 2) * step), up, (frame.height / 2 - y - 0.5) * step);
  return add(eye_of(frame.orbit), along, far);
}

const stillVertex = `
precision highp float;
void main() {
  vec2 p = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
  gl_Position = vec4(4.0 * p - 1.0, 0.0, 1.0);
}`;

const stillFragment = `
precision highp float;
uniform sampler2D color, far;
uniform vec2 size, lens;
out vec4 result;
void main() {
  ivec2 at = ivec2(gl_FragCoord.x, size.y - gl_FragCoord.y);
  float t = texelFetch(far, at, 0).r;
  if (t < 0.0) discard;
  result = texelFetch(color, at, 0);
  gl_FragDepth = t > 0.0 ? clamp(0.5 + 0.5 * (lens.y / t - lens.x), 0.0, 1.0) : 1.0;
}`;

const pointVertex = `
precision highp float;
uniform sampler2D color, far;
uniform mat4 projectionMatrix;
uniform vec3 eye, right, up, forward;
uniform vec2 size;
uniform int stride, columns;
uniform float footprint;
out vec4 tone;
void main() {
  ivec2 at = ivec2(gl_VertexID % columns, gl_VertexID / columns) * stride + stride / 2;
  float t = texelFetch(far, at, 0).r;
  tone = texelFetch(color, at, 0);
  gl_PointSize = 1.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (t <= 0.0) return;
  vec2 p = vec2(at) + 0.5 - 0.5 * size;
  vec3 place = eye + t * (forward + p.x * right - p.y * up);
  if (place.z >= 0.0) return;
  gl_Position = projectionMatrix * vec4(place, 1.0);
  gl_PointSize = clamp(footprint * t / gl_Position.w + 0.75, 1.0, 64.0);
}`;

const pointFragment = `
precision highp float;
in vec4 tone;
out vec4 result;
void main() { result = tone; }`;

function texture_of(data: Uint8Array | Float32Array, width: number, height: number): DataTexture {
  const texture = new DataTexture(data, width, height);
  if (data instanceof Float32Array) {
    texture.format = RedFormat;
    texture.type = FloatType;
  }
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

// What both ways of drawing share: a frame, as textures, and what it is drawn with.
class Drawing {
  frame: Frame | null = null;
  private readonly textures = { color: { value: null as DataTexture | null }, far: { value: null as DataTexture | null }, size: { value: new Vector2() } };
  private readonly material: RawShaderMaterial;
  protected readonly geometry = new BufferGeometry();
  readonly mesh: Mesh | Points;

  constructor(make: (geometry: BufferGeometry, material: RawShaderMaterial) => Mesh | Points, look: ShaderMaterialParameters) {
    const uniforms = { ...this.textures, ...look.uniforms };
    this.material = new RawShaderMaterial({ ...look, glslVersion: GLSL3, blending: NoBlending, uniforms });
    this.mesh = make(this.geometry, this.material);
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }
  // Also when a part of the same frame has come.
  set(frame: Frame | null): void {
    const { color, far, size } = this.textures;
    if (frame !== this.frame) {
      this.forget();
      this.frame = frame;
      this.mesh.visible = frame !== null;
      if (!frame) return;
      color.value = texture_of(frame.pixels, frame.width, frame.height);
      far.value = texture_of(frame.far, frame.width, frame.height);
      size.value.set(frame.width, frame.height);
    } else for (const { value } of [color, far]) if (value) value.needsUpdate = true;
  }
  private forget(): void {
    for (const texture of [this.textures.color, this.textures.far]) {
      texture.value?.dispose();
      texture.value = null;
    }
  }
  dispose(): void {
    this.forget();
    this.geometry.dispose();
    this.material.dispose();
  }
}

// A frame seen from its own camera, pixel by pixel.
export class Still extends Drawing {
  private readonly lens: { value: Vector2 };

  constructor() {
    const lens = { value: new Vector2() };
    super((geometry, material) => new Mesh(geometry, material), { vertexShader: stillVertex, fragmentShader: stillFragment, depthFunc: AlwaysDepth, uniforms: { lens } });
    this.lens = lens;
    this.geometry.setDrawRange(0, 3);
    this.mesh.renderOrder = 1;
  }
  // The two elements of the projection that depths depend on.
  aim(projection: Matrix4): void {
    this.lens.value.set(projection.elements[10]!, projection.elements[14]!);
  }
}

// A frame seen from any camera: each of its pixels is a point in space.
export class Cloud extends Drawing {
  private readonly place;

  constructor() {
    const place = {
      eye: { value: new Vector3() },
      right: { value: new Vector3() },
      up: { value: new Vector3() },
      forward: { value: new Vector3() },
      stride: { value: 1 },
      columns: { value: 1 },
      footprint: { value: 1 },
    };
    super((geometry, material) => new Points(geometry, material), { vertexShader: pointVertex, fragmentShader: pointFragment, uniforms: place });
    this.place = place;
  }
  // For a view of `height` pixels; at most so many points.
  aim(orbit: Orbit, aspect: number, height: number, most_points: number): void {
    const { frame } = this;
    if (!frame) return;
    const stride = Math.max(1, Math.ceil(Math.sqrt((frame.width * frame.height) / most_points)));
    const columns = Math.max(1, Math.floor(frame.width / stride));
    this.geometry.setDrawRange(0, columns * Math.max(1, Math.floor(frame.height / stride)));
    const step = (2 * reach(frame.width / frame.height).y) / frame.height; // of a pixel, at distance 1
    const view = basis(orbit);
    const turned = (v: Readonly<Vec3>, times: number) => [view.right, view.up, view.back].map((axis) => times * dot(v, axis)) as Vec3;
    const from = basis(frame.orbit);
    this.place.eye.value.set(...turned(add(eye_of(frame.orbit), eye_of(orbit), -1), 1));
    this.place.right.value.set(...turned(from.right, step));
    this.place.up.value.set(...turned(from.up, step));
    this.place.forward.value.set(...turned(from.back, -1));
    this.place.stride.value = stride;
    this.place.columns.value = columns;
    this.place.footprint.value = (1.15 * stride * step * height) / (2 * reach(aspect).y);
  }
}
