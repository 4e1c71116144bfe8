// What the overview draws, as three.js has it: bodies, planes, lines, and a camera. It knows pixels and the overview's space, nothing of
// signals, requests or the document beyond its canvas. A frame is drawn when draw() is called and not otherwise.
import { BufferAttribute, BufferGeometry, Group, Mesh, PerspectiveCamera, type RawShaderMaterial, Raycaster, Scene, Vector2, Vector3, WebGLRenderer } from "three";
import type { AxisIndex } from "../base/grid";
import type { MaterialLook } from "../base/materials";
import type { BodyMode } from "../state/viewer";
import { make_body_material, make_cut, set_look } from "./body_material";
import { type Orbit, type Projection, basis, direction_at, eye_of, projection_of } from "./camera";
import type { Vec3 } from "./level_axis";
import { type Segment, make_lines } from "./lines";
import { make_planes } from "./planes";
import type { Quality } from "./quality";
import type { Surface } from "./worker";

// Of a body that is seen through, by its distance: after the planes (from 10 on) and before the lines (from 30 on).
export const clear_order = (distance: number): number => 20 + 9 / (1 + distance);

export type Stage = ReturnType<typeof make_stage>;

// Throws when there is no WebGL 2.
export function make_stage(canvas: HTMLCanvasElement, half: Readonly<Vec3>) {
  const renderer = new WebGLRenderer({ canvas, alpha: true, antialias: false, powerPreference: "low-power", failIfMajorPerformanceCaveat: false });
  renderer.setClearColor(0, 0);
  renderer.info.autoReset = true;
  const scene = new Scene();
  scene.matrixWorldAutoUpdate = false;
  const camera = new PerspectiveCamera();
  camera.matrixAutoUpdate = false;
  camera.matrixWorldAutoUpdate = false;

  const panel = { value: new Vector2(1, 1) };
  const cut = make_cut();
  const sky = { value: new Vector3(0, 1, 0) };
  const planes = make_planes(half);
  const frames = make_lines(panel);
  const marks = make_lines(panel, { over: true });
  const bodies = new Group(); // a group for each level that has come, coarse to fine
  scene.add(bodies, planes.group, frames.mesh, marks.mesh);

  const materials = new Map<number, RawShaderMaterial>();
  const radius = Math.hypot(...half);
  let at: Vec3 = [0, 0, 0];
  let mode: BodyMode = "cut";
  let looks: readonly MaterialLook[] = [];
  let width = 1;
  let height = 1;
  let ratio = 0;

  const groups = () => bodies.children as Group[];
  const meshes = (group: Group | undefined) => (group?.children ?? []) as Mesh<BufferGeometry, RawShaderMaterial>[];
  const number_of = (mesh: Mesh) => mesh.userData.material as number;
  const material_of = (id: number) => {
    let material = materials.get(id);
    if (!material) materials.set(id, (material = make_body_material(cut, sky)));
    return material;
  };
  const dress = () => {
    for (const [id, material] of materials) if (looks[id]) set_look(material, looks[id], mode);
    for (const group of groups())
      for (const mesh of meshes(group)) {
        const look = looks[number_of(mesh)];
        mesh.visible = look !== undefined && look.visible && look.opacity > 0;
        if (!mesh.material.transparent) mesh.renderOrder = 0; // they hide each other, so they come first
      }
  };
  // From far to near: what is seen through doesn't hide what is drawn later.
  const sort_clear = (eye: Vector3) => {
    for (const group of groups())
      for (const mesh of meshes(group)) if (mesh.material.transparent) mesh.renderOrder = clear_order(mesh.geometry.boundingSphere!.center.distanceTo(eye));
  };
  const clear_bodies = () => {
    for (const group of groups()) for (const mesh of meshes(group)) mesh.geometry.dispose();
    bodies.clear();
  };

  const aim = (orbit: Orbit) => {
    const { right, up, back } = basis(orbit);
    const eye = eye_of(orbit);
    camera.matrixWorld.makeBasis(new Vector3(...right), new Vector3(...up), new Vector3(...back)).setPosition(...eye);
    camera.matrixWorldInverse.copy(camera.matrixWorld).invert();
    const { x, y } = projection_of(orbit, width, height).reach;
    const away = Math.hypot(...eye);
    const near = Math.max(away - 1.2 * radius, 0.004);
    camera.projectionMatrix.makePerspective(-x * near, x * near, y * near, -y * near, near, Math.max(away + 1.2 * radius, 2 * near), renderer.coordinateSystem);
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
    sky.value.set(right[2], up[2], back[2]);
    const toward = at.map((x, d) => (eye[d]! >= x ? 1 : -1)) as Vec3;
    planes.sort(toward);
    sort_clear(new Vector3(...eye));
    cut.at.value.set(...at);
    cut.toward.value.set(...(mode === "cut" ? toward : ([0, 0, 0] as Vec3)));
  };

  return {
    canvas,
    planes,
    set_size(w: number, h: number) {
      width = Math.max(w, 1);
      height = Math.max(h, 1);
      panel.value.set(width, height);
      ratio = 0;
    },
    projection: (orbit: Orbit): Projection => projection_of(orbit, width, height),

    clear_bodies,
    // Finer surfaces than those before.
    add_bodies(surfaces: readonly Surface[]) {
      const group = new Group();
      bodies.add(group);
      for (const surface of surfaces) {
        const geometry = new BufferGeometry();
        geometry.setAttribute("position", new BufferAttribute(surface.positions, 3));
        geometry.setAttribute("shade", new BufferAttribute(surface.shades, 4, true));
        geometry.setIndex(new BufferAttribute(surface.indices, 1));
        geometry.computeBoundingSphere();
        const mesh = new Mesh(geometry, material_of(surface.material));
        mesh.userData.material = surface.material;
        group.add(mesh);
      }
      dress();
    },
    set_looks(to: readonly MaterialLook[], to_mode: BodyMode) {
      looks = to;
      mode = to_mode;
      dress();
    },
    set_point(p: Vec3) {
      at = p;
      planes.move(p);
    },
    set_lines(under: readonly Segment[], over: readonly Segment[]) {
      frames.set(under);
      marks.set(over);
    },

    // Draws, and when asked waits until the picture is done: then returns the milliseconds that it took.
    draw(orbit: Orbit, quality: Quality, wait: boolean): number {
      const began = performance.now();
      if (ratio !== quality.ratio) {
        ratio = quality.ratio;
        renderer.setPixelRatio(ratio);
        renderer.setSize(width, height, false);
      }
      aim(orbit);
      const shown = Math.max(groups().length - 1 - quality.coarser, 0);
      groups().forEach((group, i) => (group.visible = i === shown));
      renderer.render(scene, camera);
      if (!wait) return 0;
      const gl = renderer.getContext();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      return performance.now() - began;
    },

    // The nearest thing that is seen at a pixel: a body, a plane where it shows a body; else a plane at all.
    pick(orbit: Orbit, x: number, y: number): Vec3 | null {
      const view = projection_of(orbit, width, height);
      const direction = new Vector3(...direction_at(view, x, y)).normalize();
      const eye = new Vector3(...view.eye);
      const caster = new Raycaster(eye, direction);
      const removed = (p: Vector3) => cut.toward.value.x !== 0 && [p.x, p.y, p.z].every((c, d) => (c - at[d]!) * cut.toward.value.getComponent(d) > 0);
      let best: { far: number; p: Vector3 } | null = null;
      for (const hit of caster.intersectObjects(meshes(groups().at(-1)).filter((mesh) => mesh.visible), false))
        if (!removed(hit.point) && (!best || hit.distance < best.far)) best = { far: hit.distance, p: hit.point };
      let fallback: { far: number; p: Vector3 } | null = null;
      for (const d of [0, 1, 2] as AxisIndex[]) {
        const far = (at[d] - eye.getComponent(d)) / direction.getComponent(d);
        if (!(far > 0) || !Number.isFinite(far)) continue;
        const p = eye.clone().addScaledVector(direction, far);
        if ([p.x, p.y, p.z].some((c, k) => k !== d && Math.abs(c) > half[k]!)) continue;
        const found = { far, p: p.setComponent(d, at[d]) };
        if (planes.opacity_at(d, [p.x, p.y, p.z]) > 0.1) {
          if (!best || far < best.far) best = found;
        } else if (!fallback || far < fallback.far) fallback = found;
      }
      const p = (best ?? fallback)?.p;
      return p ? [p.x, p.y, p.z] : null;
    },

    // The context goes first: everything in it is free at once, also what an earlier, lost one left.
    dispose() {
      renderer.forceContextLoss();
      clear_bodies();
      for (const material of materials.values()) material.dispose();
      planes.dispose();
      frames.dispose();
      marks.dispose();
      renderer.dispose();
    },
  };
}
