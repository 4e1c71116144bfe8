// Where the overview is looked at from: the viewer's orbit, in the overview's space, and flights from one view to
// another.
import type { Viewer } from "../../state/viewer";
import { FARTHEST, HOME, type Orbit, between, fitted, in_sight } from "./camera";
import { type Space, type Vec3, from_space, point_to_space } from "./space";

const FLIGHT = 320; // milliseconds from view to view
const FAR_FLIGHT = 900; // where the distance changes much

export class Viewpoint {
  own = false; // whether the viewer's orbit is being changed here, and not elsewhere on the page
  private flight: { from: Orbit; to: Orbit; began: number; goes_home: boolean } | null = null;

  constructor(
    private readonly viewer: Viewer,
    private readonly space: Space,
    public aspect = 1, // the panel's width divided by its height
  ) {}

  // The view that shows the whole domain, from a direction.
  home(azimuth = HOME.azimuth, elevation = HOME.elevation): Orbit {
    return fitted(this.space.half, azimuth, elevation, this.aspect, 0.8, this.viewer.sky.value);
  }

  // The view that shows a box, from the direction of the present one.
  framing(low: Vec3, high: Vec3, nearest: number): Orbit {
    const { azimuth, elevation } = this.orbit;
    const half = high.map((x, d) => (x - low[d]!) / 2) as Vec3;
    const fits = fitted(half, azimuth, elevation, this.aspect, 0.8, this.viewer.sky.value);
    return { ...fits, target: high.map((x, d) => (x + low[d]!) / 2) as Vec3, distance: Math.min(Math.max(fits.distance, nearest), FARTHEST) };
  }

  sees(point: Vec3): boolean {
    return in_sight(this.orbit, point, this.aspect);
  }

  get orbit(): Orbit {
    const orbit = this.viewer.orbit.value;
    return orbit ? { ...orbit, target: point_to_space(this.space, orbit.target), sky: this.viewer.sky.value } : this.home();
  }

  // Ends any flight.
  move(to: Orbit): void {
    this.flight = null;
    this.set(to);
  }

  // With `goes_home`, the view follows the size of the panel once it has arrived.
  fly(to: Orbit, goes_home = false): void {
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) this.set(goes_home ? null : to);
    else this.flight = { from: this.orbit, to, began: performance.now(), goes_home };
  }

  // The next step of a flight. False when there is none, or this was the last one.
  advance(): boolean {
    if (!this.flight) return false;
    const { from, to, began, goes_home } = this.flight;
    const ratio = to.distance / from.distance;
    const t = Math.min((performance.now() - began) / (ratio > 0.25 && ratio < 4 ? FLIGHT : FAR_FLIGHT), 1);
    this.set(between(from, to, t * t * (3 - 2 * t)));
    if (t < 1) return true;
    if (goes_home) this.set(null);
    this.flight = null;
    return false;
  }

  private set(to: Orbit | null): void {
    this.own = true;
    this.viewer.orbit.value = to && {
      azimuth: to.azimuth,
      elevation: to.elevation,
      distance: to.distance,
      target: to.target.map((x, d) => from_space(this.space, d, x)) as Vec3,
    };
    this.own = false;
  }
}
