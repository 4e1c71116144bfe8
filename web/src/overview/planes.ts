// The three slice planes. Each consists of four quads, cut along the crosshair. No two of the twelve quads intersect,
// so they blend correctly when they are drawn from far to near. A plane shows its picture over a tint so faint that it
// marks the plane and hides nothing. Every quad is drawn twice: first the nearly opaque parts of its picture, which
// hide bodies of glass behind them, and then the rest, which hides nothing.
import {
  BufferAttribute, BufferGeometry, DataTexture, GLSL3, Group, LinearFilter, LinearMipmapNearestFilter, Mesh, NearestFilter, RawShaderMaterial,
  Vector4, DoubleSide,
} from "three";
import { FRAMES } from "../base/axis";
import type { AxisIndex } from "../base/grid";
import type { Vec3 } from "./level_axis";
import type { Picture } from "./slice_picture";

const vertexShader = `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
in vec3 position;
in vec2 uv;
out vec2 place;
void main() {
  place = uv;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const fragmentShader = `
precision highp float;
uniform sampler2D picture;
uniform vec4 tint;
uniform float solid;
in vec2 place;
out vec4 result;
void main() {
  vec4 color = texture(picture, place);
  if ((color.a > 0.6) != (solid > 0.5)) discard;
  result = color + tint * (1.0 - color.a);
}`;

function texture_of(picture: Picture): DataTexture {
  const texture = new DataTexture(picture.pixels, picture.width, picture.height);
  texture.magFilter = NearestFilter;
  texture.minFilter = LinearMipmapNearestFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = 1;
  texture.needsUpdate = true;
  return texture;
}

function blank(): DataTexture {
  const texture = new DataTexture(new Uint8Array(4), 1, 1);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

interface Plane {
  readonly uniforms: { picture: { value: DataTexture }; tint: { value: Vector4 } };
  readonly materials: RawShaderMaterial[]; // for the solid parts, and for the rest
  readonly quads: { geometry: BufferGeometry; meshes: Mesh[] }[];
  used: readonly [number, number];
}

export interface Planes {
  readonly group: Group;
  // Moves the planes through a point of the overview's space.
  move(at: Vec3): void;
  // Orders the quads from far to near, for a camera on these sides of the point (1 or -1).
  sort(toward: Vec3): void;
  set_picture(axis: AxisIndex, picture: Picture | null): void;
  set_tint(axis: AxisIndex, premultiplied: readonly [number, number, number, number]): void;
  // The picture's opacity, 0 to 1, at a point of the plane.
  opacity_at(axis: AxisIndex, p: Vec3): number;
  dispose(): void;
}

const ORDER = 10; // after the opaque bodies

export function make_planes(half: Readonly<Vec3>): Planes {
  const group = new Group();
  const pictures: (Picture | null)[] = [null, null, null];
  const planes = ([0, 1, 2] as const).map((): Plane => {
    const uniforms = { picture: { value: blank() }, tint: { value: new Vector4() } };
    const materials = [1, 0].map(
      (solid) =>
        new RawShaderMaterial({
          glslVersion: GLSL3,
          vertexShader,
          fragmentShader,
          uniforms: { ...uniforms, solid: { value: solid } },
          side: DoubleSide,
          premultipliedAlpha: true,
          transparent: true,
          depthWrite: solid === 1,
        }),
    );
    const quads = [0, 1, 2, 3].map(() => {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(new Float32Array(12), 3));
      geometry.setAttribute("uv", new BufferAttribute(new Float32Array(8), 2));
      geometry.setIndex([0, 1, 2, 2, 1, 3]);
      const meshes = materials.map((material) => new Mesh(geometry, material));
      for (const mesh of meshes) mesh.frustumCulled = false;
      group.add(...meshes);
      return { geometry, meshes };
    });
    return { uniforms, materials, quads, used: [1, 1] };
  });
  let at: Vec3 = [0, 0, 0];

  const lay = (d: AxisIndex) => {
    const { u, v } = FRAMES[d];
    const plane = planes[d]!;
    plane.quads.forEach((quad, q) => {
      const position = quad.geometry.getAttribute("position") as BufferAttribute;
      const uv = quad.geometry.getAttribute("uv") as BufferAttribute;
      for (let corner = 0; corner < 4; ++corner) {
        const end = (axis: AxisIndex, upper_half: boolean, upper_end: boolean) =>
          upper_half === upper_end ? (upper_half ? half[axis] : -half[axis]) : at[axis];
        const p: Vec3 = [...at];
        p[u] = end(u, (q & 1) === 1, (corner & 1) === 1);
        p[v] = end(v, (q & 2) === 2, (corner & 2) === 2);
        position.setXYZ(corner, p[0], p[1], p[2]);
        const share = (axis: AxisIndex) => (half[axis] > 0 ? (p[axis] + half[axis]) / (2 * half[axis]) : 0);
        uv.setXY(corner, share(u) * plane.used[0], share(v) * plane.used[1]);
      }
      position.needsUpdate = uv.needsUpdate = true;
    });
  };

  return {
    group,
    move(to) {
      at = to;
      for (const d of [0, 1, 2] as const) lay(d);
    },
    sort(toward) {
      planes.forEach((plane, d) => {
        const { u, v } = FRAMES[d]!;
        plane.quads.forEach((quad, q) => {
          const nearer = Number(((q & 1) === 1) === toward[u] > 0) + Number(((q & 2) === 2) === toward[v] > 0);
          quad.meshes.forEach((mesh, rest) => (mesh.renderOrder = ORDER + 3 * rest + nearer));
        });
      });
    },
    set_picture(d, picture) {
      const plane = planes[d]!;
      plane.uniforms.picture.value.dispose();
      plane.uniforms.picture.value = picture ? texture_of(picture) : blank();
      plane.used = picture?.used ?? [1, 1];
      pictures[d] = picture;
      lay(d);
    },
    set_tint(d, color) {
      planes[d]!.uniforms.tint.value.set(...color);
    },
    opacity_at(d, p) {
      const picture = pictures[d];
      if (!picture) return 0;
      const { u, v } = FRAMES[d];
      const pixel = (axis: AxisIndex, cells: number, used: number) =>
        Math.min(Math.max(Math.floor(((p[axis] + half[axis]) / (2 * half[axis])) * used * cells), 0), cells - 1);
      const x = pixel(u, picture.width, picture.used[0]);
      const y = pixel(v, picture.height, picture.used[1]);
      return picture.pixels[4 * (y * picture.width + x) + 3]! / 255;
    },
    dispose() {
      for (const plane of planes) {
        plane.uniforms.picture.value.dispose();
        for (const material of plane.materials) material.dispose();
        for (const quad of plane.quads) quad.geometry.dispose();
      }
    },
  };
}
