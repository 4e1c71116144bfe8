// Gets the coarse bodies: cubes of a pyramid level from the server, and their surfaces from the worker. The first level
// is one that fits into a single cube, so that something is there after one request. Finer levels follow, with up to
// MOST_CELLS per side, unless their surfaces are too large.
import type { Index3 } from "../base/grid";
import { get } from "../server/api";
import type { Viewer } from "../state/viewer";
import { cells_of_level, level_planes, level_within, type Space, to_space } from "./level_axis";
import { CUBE, type Cube, cubes_of } from "./volume";
import type { Surface, SurfaceAnswer, SurfaceJob } from "./worker";

const MOST_CELLS = 160;
const MOST_TRIANGLES = 2_000_000;
const AT_ONCE = 3; // requests: browsers open six connections, and the slices come first

export interface Bodies {
  readonly level: number;
  readonly surfaces: readonly Surface[];
}

export function levels_to_show(cells: Index3, levels: number): number[] {
  const first = level_within(cells, CUBE, levels);
  const last = level_within(cells, MOST_CELLS, levels);
  return Array.from({ length: first - last + 1 }, (_, i) => first - i);
}

async function fetch_cubes(viewer: Viewer, level: number, signal: AbortSignal): Promise<Cube[]> {
  const waiting = cubes_of(cells_of_level(viewer.cells, level));
  const cubes: Cube[] = [];
  const take = async () => {
    for (let place = waiting.shift(); place; place = waiting.shift()) {
      const response = await get(viewer.address.cube(level, place), { signal, priority: "low" });
      cubes.push({ place, bytes: await response.arrayBuffer() });
    }
  };
  await Promise.all(Array.from({ length: AT_ONCE }, take));
  return cubes;
}

function ask(worker: Worker, job: SurfaceJob, signal: AbortSignal): Promise<SurfaceAnswer> {
  return new Promise((resolve, reject) => {
    signal.addEventListener("abort", () => reject(new DOMException("", "AbortError")), { once: true });
    worker.onmessage = (event: MessageEvent<SurfaceAnswer>) => resolve(event.data);
    worker.onerror = (event) => reject(new Error(event.message || "the worker that makes surfaces could not be started"));
    worker.postMessage(job, { transfer: job.cubes.map((cube) => cube.bytes) });
  });
}

// Calls `show` with ever finer bodies. Throws what went wrong, or AbortError when the signal ends it.
export async function load_bodies(viewer: Viewer, space: Space, signal: AbortSignal, show: (bodies: Bodies) => void): Promise<void> {
  const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module", name: "surfaces" });
  try {
    for (const level of levels_to_show(viewer.cells, viewer.info.levels.length)) {
      const cells = cells_of_level(viewer.cells, level);
      const planes = viewer.axes.map((axis, d) => level_planes(axis, level).map((x) => to_space(space, d, x)));
      const cubes = await fetch_cubes(viewer, level, signal);
      const { materials } = viewer.info;
      const ranks = materials.map((material) => material.rank);
      const answer = await ask(
        worker,
        { size: cells, level, ranks, wide: materials.length > 256, planes, cubes, most_triangles: MOST_TRIANGLES },
        signal,
      );
      if ("failed" in answer) throw new Error(answer.failed);
      if ("too_many" in answer) return; // the coarser bodies stay
      show({ level, surfaces: answer.surfaces });
    }
  } finally {
    worker.terminate();
  }
}
