// Lines with a width in pixels, which WebGL does not draw by itself: each segment is a quad that the shader widens on
// the screen. A segment without length becomes a round dot.
import { BufferAttribute, DynamicDrawUsage, GLSL3, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, RawShaderMaterial, Vector2 } from "three";
import type { Vec3 } from "./space";

const vertexShader = `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform vec2 panel;
uniform float nearer;
in vec3 position, a, b;
in vec4 color;
in float width;
out vec4 tone;
out vec2 inside;
out float half_length, radius;
void main() {
  vec4 p = projectionMatrix * modelViewMatrix * vec4(a, 1.0);
  vec4 q = projectionMatrix * modelViewMatrix * vec4(b, 1.0);
  float near = 0.001;
  if (p.w < near) p = mix(p, q, (near - p.w) / (q.w - p.w));
  if (q.w < near) q = mix(q, p, (near - q.w) / (p.w - q.w));
  vec2 from = p.xy / p.w * panel * 0.5, to = q.xy / q.w * panel * 0.5;
  float len = length(to - from);
  vec2 along = len > 1e-4 ? (to - from) / len : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  radius = 0.5 * width;
  float r = radius + 1.0;
  half_length = 0.5 * len;
  inside = vec2(position.x * (half_length + r), position.y * r);
  vec4 end = position.x < 0.0 ? p : q;
  vec2 pixel = (from + to) * 0.5 + along * inside.x + across * inside.y;
  gl_Position = vec4(pixel / panel * 2.0 * end.w, end.z - nearer * end.w, end.w);
  tone = color;
}`;

const fragmentShader = `
precision highp float;
in vec4 tone;
in vec2 inside;
in float half_length, radius;
out vec4 result;
void main() {
  float away = length(vec2(max(abs(inside.x) - half_length, 0.0), inside.y));
  float cover = clamp(radius + 0.5 - away, 0.0, 1.0) * tone.a;
  if (cover < 0.004) discard;
  result = vec4(tone.rgb * cover, cover);
}`;

export type Rgba = readonly [number, number, number, number]; // 0 to 1, straight alpha

export interface Segment {
  readonly a: Readonly<Vec3>;
  readonly b: Readonly<Vec3>;
  readonly color: Rgba;
  readonly width: number; // CSS pixels
}

const NEARER = 0.0006; // of depths: lines lie in front of the surfaces that they run along

// `panel` is the panel's size in CSS pixels, which all lines share. Lines that are `over` everything else show through
// bodies.
export function make_lines(panel: { value: Vector2 }, over = false) {
  const material = new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    uniforms: { panel, nearer: { value: NEARER } },
    transparent: true,
    premultipliedAlpha: true,
    depthWrite: false,
    depthTest: !over,
  });
  const mesh = new Mesh(new InstancedBufferGeometry(), material);
  mesh.frustumCulled = false;
  mesh.renderOrder = over ? 40 : 30;

  let capacity = 0;
  const grow = (count: number) => {
    mesh.geometry.dispose();
    capacity = Math.max(count, 16);
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, -1, 1, 0, 1, 1, 0]), 3));
    geometry.setIndex([0, 1, 2, 2, 1, 3]);
    for (const [name, n] of [["a", 3], ["b", 3], ["color", 4], ["width", 1]] as const) {
      const attribute = new InstancedBufferAttribute(new Float32Array(n * capacity), n);
      attribute.setUsage(DynamicDrawUsage);
      geometry.setAttribute(name, attribute);
    }
    mesh.geometry = geometry;
  };

  return {
    mesh,
    set(segments: readonly Segment[]) {
      if (segments.length > capacity) grow(segments.length);
      mesh.visible = segments.length > 0;
      if (!mesh.visible) return;
      mesh.geometry.instanceCount = segments.length;
      const put = (name: string, of: (s: Segment) => readonly number[]) => {
        const attribute = mesh.geometry.getAttribute(name) as InstancedBufferAttribute;
        segments.forEach((s, i) => attribute.array.set(of(s), i * attribute.itemSize));
        attribute.needsUpdate = true;
      };
      put("a", (s) => s.a);
      put("b", (s) => s.b);
      put("color", (s) => s.color);
      put("width", (s) => [s.width]);
    },
    dispose() {
      mesh.geometry.dispose();
      material.dispose();
    },
  };
}

// The edges of a box. Each has the axis that it runs along, and its place among the four edges of that axis: bit 0 is
// set at the upper end of the next axis, and bit 1 at the upper end of the one after that.
export function box_edges(low: Readonly<Vec3>, high: Readonly<Vec3>): { axis: number; place: number; a: Vec3; b: Vec3 }[] {
  const edges = [];
  for (let axis = 0; axis < 3; ++axis)
    for (let place = 0; place < 4; ++place) {
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      const a: Vec3 = [...low];
      a[u] = place & 1 ? high[u]! : low[u]!;
      a[v] = place & 2 ? high[v]! : low[v]!;
      const b: Vec3 = [...a];
      b[axis] = high[axis]!;
      edges.push({ axis, place, a, b });
    }
  return edges;
}
