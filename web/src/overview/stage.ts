// What the overview draws, as three.js has it: what is seen, lines, and a camera. It knows pixels and the overview's
// space, but no signals, no requests, and of the document only its canvas. A frame is drawn when draw() is called, and
// at no other time.
import { PerspectiveCamera, Scene, Vector2, Vector3, WebGLRenderer } from "three";
import { type Orbit, type Projection, basis, eye_of, projection_of } from "./space/camera";
import { Cloud, type Frame, Still } from "./frame";
import { type Segment, make_lines } from "./space/lines";
import type { Quality } from "./quality";
import type { Vec3 } from "./space/space";

export class Stage {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera();
  private readonly panel = { value: new Vector2(1, 1) }; // its size in CSS pixels
  // What is seen from somewhere, to be drawn from anywhere.
  readonly cloud = new Cloud();
  // What is seen from where the camera is. It lies over the cloud, which fills what has not come yet.
  readonly still = new Still();
  private readonly frames = make_lines(this.panel);
  private readonly marks = make_lines(this.panel, true);
  private buffer: readonly [number, number] = [0, 0]; // the size of the canvas in its own pixels

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
    this.scene.add(this.cloud.mesh, this.still.mesh, this.frames.mesh, this.marks.mesh);
  }

  set_size(width: number, height: number): void {
    this.panel.value.set(Math.max(width, 1), Math.max(height, 1));
  }

  projection(orbit: Orbit): Projection {
    return projection_of(orbit, this.panel.value.x, this.panel.value.y);
  }

  // The camera has left the place that the still was seen from: from now on a whole one is drawn as points.
  leave(is_whole: boolean): void {
    const { frame } = this.still;
    if (!frame) return;
    this.still.set(null);
    if (is_whole) this.cloud.set(frame);
  }
  get shown(): Frame | null {
    return this.still.frame ?? this.cloud.frame;
  }

  set_lines(under: readonly Segment[], over: readonly Segment[]): void {
    this.frames.set(under);
    this.marks.set(over);
  }

  // With `wait` it waits until the picture is done and returns the milliseconds that it took; otherwise it returns 0.
  draw(orbit: Orbit, quality: Quality, wait: boolean): number {
    const { renderer } = this;
    const began = performance.now();
    const { x, y } = this.panel.value;
    const still = this.still.frame;
    const [width, height] = still ? [still.width, still.height] : [Math.round(x * quality.ratio), Math.round(y * quality.ratio)];
    if (this.buffer[0] !== width || this.buffer[1] !== height) {
      this.buffer = [width, height];
      renderer.setPixelRatio(1);
      renderer.setSize(width, height, false);
    }
    this.aim(orbit);
    this.cloud.aim(orbit, x / y, height, quality.points);
    this.still.aim(this.camera.projectionMatrix);
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
    const near = Math.max(away - 1.2 * radius, 0.02 * orbit.distance);
    const far = Math.max(away + 1.2 * radius, 2 * near);
    camera.projectionMatrix.makePerspective(-x * near, x * near, y * near, -y * near, near, far, renderer.coordinateSystem);
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
  }

  // The context goes first: then everything in it is free at once, including what an earlier context left that was
  // lost.
  dispose(): void {
    this.renderer.forceContextLoss();
    this.cloud.dispose();
    this.still.dispose();
    this.frames.dispose();
    this.marks.dispose();
    this.renderer.dispose();
  }
}
