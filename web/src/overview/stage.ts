// What the overview draws, as three.js has it: bodies, planes, lines, and a camera. It knows pixels and the overview's
// space, but no signals, no requests, and of the document only its canvas. A frame is drawn when draw() is called, and
// at no other time.
import { PerspectiveCamera, Raycaster, Scene, Vector2, Vector3, WebGLRenderer } from "three";
import type { AxisIndex } from "../base/grid";
import type { MaterialLook } from "../base/materials";
import type { BodyMode } from "../state/viewer";
import { make_cut } from "./body_material";
import { BodyMeshes } from "./body_meshes";
import { type Orbit, type Projection, basis, direction_at, eye_of, projection_of } from "./camera";
import type { Vec3 } from "./level_axis";
import { type Segment, make_lines } from "./lines";
import { type Planes, make_planes } from "./planes";
import type { Quality } from "./quality";
import type { Surface } from "./worker";

interface Hit {
  readonly far: number;
  readonly p: Vector3;
}

const nearest = (hits: readonly Hit[]): Hit | undefined =>
  hits.reduce<Hit | undefined>((best, hit) => (best && best.far <= hit.far ? best : hit), undefined);

export class Stage {
  readonly planes: Planes;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera();
  private readonly panel = { value: new Vector2(1, 1) }; // its size in CSS pixels
  private readonly cut = make_cut();
  private readonly sky = { value: new Vector3(0, 1, 0) };
  private readonly bodies = new BodyMeshes(this.cut, this.sky);
  private readonly frames = make_lines(this.panel);
  private readonly marks = make_lines(this.panel, { over: true });
  private at: Vec3 = [0, 0, 0]; // the crosshair
  private mode: BodyMode = "cut";
  private ratio = 0; // device pixels per CSS pixel; 0: to be set

  // The domain is -half to half. Throws when there is no WebGL 2.
  constructor(
    canvas: HTMLCanvasElement,
    private readonly half: Readonly<Vec3>,
  ) {
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: false, powerPreference: "low-power", failIfMajorPerformanceCaveat: false });
    this.renderer.setClearColor(0, 0);
    this.renderer.info.autoReset = true;
    this.scene.matrixWorldAutoUpdate = false;
    this.camera.matrixAutoUpdate = false;
    this.camera.matrixWorldAutoUpdate = false;
    this.planes = make_planes(half);
    this.scene.add(this.bodies.root, this.planes.group, this.frames.mesh, this.marks.mesh);
  }

  set_size(width: number, height: number): void {
    this.panel.value.set(Math.max(width, 1), Math.max(height, 1));
    this.ratio = 0;
  }

  projection(orbit: Orbit): Projection {
    return projection_of(orbit, this.panel.value.x, this.panel.value.y);
  }

  clear_bodies(): void {
    this.bodies.clear();
  }

  add_bodies(surfaces: readonly Surface[]): void {
    this.bodies.add(surfaces);
  }

  set_looks(looks: readonly MaterialLook[], mode: BodyMode): void {
    this.mode = mode;
    this.bodies.set_looks(looks, mode);
  }

  set_point(p: Vec3): void {
    this.at = p;
    this.planes.move(p);
  }

  set_lines(under: readonly Segment[], over: readonly Segment[]): void {
    this.frames.set(under);
    this.marks.set(over);
  }

  // With `wait` it waits until the picture is done and returns the milliseconds that it took; otherwise it returns 0.
  draw(orbit: Orbit, quality: Quality, wait: boolean): number {
    const { renderer } = this;
    const began = performance.now();
    if (this.ratio !== quality.ratio) {
      this.ratio = quality.ratio;
      renderer.setPixelRatio(this.ratio);
      renderer.setSize(this.panel.value.x, this.panel.value.y, false);
    }
    this.aim(orbit);
    this.bodies.show(quality.coarser);
    renderer.render(this.scene, this.camera);
    if (!wait) return 0;
    const gl = renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    return performance.now() - began;
  }

  private aim(orbit: Orbit): void {
    const { camera, renderer } = this;
    const { right, up, back } = basis(orbit);
    const eye = eye_of(orbit);
    camera.matrixWorld.makeBasis(new Vector3(...right), new Vector3(...up), new Vector3(...back)).setPosition(...eye);
    camera.matrixWorldInverse.copy(camera.matrixWorld).invert();
    const { x, y } = this.projection(orbit).reach;
    const away = Math.hypot(...eye);
    const radius = Math.hypot(...this.half);
    const near = Math.max(away - 1.2 * radius, 0.004);
    camera.projectionMatrix.makePerspective(
      -x * near,
      x * near,
      y * near,
      -y * near,
      near,
      Math.max(away + 1.2 * radius, 2 * near),
      renderer.coordinateSystem,
    );
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
    this.sky.value.set(right[2], up[2], back[2]);
    const toward = this.at.map((x, d) => (eye[d]! >= x ? 1 : -1)) as Vec3;
    this.planes.sort(toward);
    this.bodies.sort(new Vector3(...eye));
    this.cut.at.value.set(...this.at);
    this.cut.toward.value.set(...(this.mode === "cut" ? toward : ([0, 0, 0] as Vec3)));
  }

  // The nearest thing that is seen at a pixel: a body, or a plane where it shows one; if there is neither, any plane.
  pick(orbit: Orbit, x: number, y: number): Vec3 | null {
    const view = this.projection(orbit);
    const direction = new Vector3(...direction_at(view, x, y)).normalize();
    const eye = new Vector3(...view.eye);
    const planes = this.planes_on(eye, direction);
    const seen = planes.filter(({ p, d }) => this.planes.opacity_at(d, [p.x, p.y, p.z]) > 0.1);
    const p = (nearest([...this.bodies_on(eye, direction), ...seen]) ?? nearest(planes))?.p;
    return p ? [p.x, p.y, p.z] : null;
  }

  // Where a ray meets bodies that are not cut away there.
  private bodies_on(eye: Vector3, direction: Vector3): Hit[] {
    const { at, toward } = this.cut;
    const is_cut = (p: Vector3) =>
      toward.value.x !== 0 && [0, 1, 2].every((d) => (p.getComponent(d) - at.value.getComponent(d)) * toward.value.getComponent(d) > 0);
    const hits = new Raycaster(eye, direction).intersectObjects(this.bodies.visible(), false);
    return hits.filter(({ point }) => !is_cut(point)).map(({ distance, point }) => ({ far: distance, p: point }));
  }

  // Where a ray meets the planes within the domain.
  private planes_on(eye: Vector3, direction: Vector3): (Hit & { d: AxisIndex })[] {
    return ([0, 1, 2] as const).flatMap((d) => {
      const far = (this.at[d] - eye.getComponent(d)) / direction.getComponent(d);
      if (!(far > 0) || !Number.isFinite(far)) return [];
      const p = eye.clone().addScaledVector(direction, far).setComponent(d, this.at[d]);
      const is_outside = this.half.some((half, k) => k !== d && Math.abs(p.getComponent(k)) > half);
      return is_outside ? [] : [{ far, p, d }];
    });
  }

  // The context goes first: then everything in it is free at once, including what an earlier context left that was
  // lost.
  dispose(): void {
    this.renderer.forceContextLoss();
    this.bodies.dispose();
    this.planes.dispose();
    this.frames.dispose();
    this.marks.dispose();
    this.renderer.dispose();
  }
}
