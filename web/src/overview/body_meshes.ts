// The bodies as three.js has them: a group for each level that has come, from coarse to fine, with a mesh per material.
import { BufferAttribute, BufferGeometry, Group, Mesh, type RawShaderMaterial, type Vector3 } from "three";
import type { MaterialLook } from "../base/materials";
import type { BodyMode } from "../state/viewer";
import { type Cut, make_body_material, set_look } from "./body_material";
import type { Surface } from "./worker";

// The order in which a transparent body at a distance is drawn: after the planes (from 10 on) and before the lines
// (from 30 on).
export const clear_order = (distance: number): number => 20 + 9 / (1 + distance);

type BodyMesh = Mesh<BufferGeometry, RawShaderMaterial>;

export class BodyMeshes {
  readonly root = new Group();
  private readonly materials = new Map<number, RawShaderMaterial>();
  private looks: readonly MaterialLook[] = [];
  private mode: BodyMode = "cut";

  // `up` points to the sky, as the camera sees it.
  constructor(
    private readonly cut: Cut,
    private readonly up: { value: Vector3 },
  ) {}

  // Adds the surfaces of a finer level than those before.
  add(surfaces: readonly Surface[]): void {
    const group = new Group();
    for (const surface of surfaces) {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(surface.positions, 3));
      geometry.setAttribute("shade", new BufferAttribute(surface.shades, 4, true));
      geometry.setIndex(new BufferAttribute(surface.indices, 1));
      geometry.computeBoundingSphere();
      const mesh = new Mesh(geometry, this.material_of(surface.material));
      mesh.userData.material = surface.material;
      group.add(mesh);
    }
    this.root.add(group);
    this.dress();
  }

  clear(): void {
    for (const mesh of this.all()) mesh.geometry.dispose();
    this.root.clear();
  }

  set_looks(looks: readonly MaterialLook[], mode: BodyMode): void {
    this.looks = looks;
    this.mode = mode;
    this.dress();
  }

  // Orders transparent bodies from far to near, so that none hides what is drawn later.
  sort(eye: Vector3): void {
    for (const mesh of this.all())
      if (mesh.material.transparent) mesh.renderOrder = clear_order(mesh.geometry.boundingSphere!.center.distanceTo(eye));
  }

  // Shows one level only: the finest, or one that is coarser by this many levels.
  show(coarser: number): void {
    const shown = Math.max(this.root.children.length - 1 - coarser, 0);
    this.root.children.forEach((group, i) => (group.visible = i === shown));
  }

  // The bodies of the finest level that are not hidden.
  visible(): BodyMesh[] {
    return ((this.root.children.at(-1)?.children ?? []) as BodyMesh[]).filter((mesh) => mesh.visible);
  }

  dispose(): void {
    this.clear();
    for (const material of this.materials.values()) material.dispose();
  }

  private all(): BodyMesh[] {
    return this.root.children.flatMap((group) => group.children as BodyMesh[]);
  }

  private material_of(id: number): RawShaderMaterial {
    let material = this.materials.get(id);
    if (!material) this.materials.set(id, (material = make_body_material(this.cut, this.up)));
    return material;
  }

  private dress(): void {
    for (const [id, material] of this.materials) if (this.looks[id]) set_look(material, this.looks[id], this.mode);
    for (const mesh of this.all()) {
      const look = this.looks[mesh.userData.material as number];
      mesh.visible = look !== undefined && look.visible && look.opacity > 0;
      if (!mesh.material.transparent) mesh.renderOrder = 0; // they hide each other, so they come first
    }
  }
}
