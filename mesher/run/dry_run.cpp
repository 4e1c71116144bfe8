#include "mesher/run/dry_run.hpp"

#include <algorithm>
#include <chrono>

#include "mesher/engines/engines.hpp"
#include "mesher/run/read_scene.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {

DryRun dry_run(const Scene& scene, const MeshOptions& options, const Progress& progress, const std::atomic<bool>& stop) {
  const Budget budget{options.memory, options.tmp.empty() ? std::filesystem::temp_directory_path() : options.tmp, searches_scene(options.engine)};
  const int threads = threads_of(options);
  const auto said = [&](const char* phase, double share) {
    if (stop) throw Interrupted("interrupted");
    progress(phase, share, 1);
  };
  const auto began = std::chrono::steady_clock::now();
  const Bodies bodies = read_scene(scene, options, threads, budget, false, false, said);
  DryRun out;
  out.read_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  out.plan = make_plan(scene, bodies, options.axis, options.chunk_rays, options.fractions, options.links);
  out.facets = bodies.facet_count();
  // Measured on two cores of 2.6 GHz with surfaces of some million facets: 50 ns for each crossing, 5 ns for each ray, 1.1 bits for each crossing.
  const Grid& grid = out.plan.meta.grid;
  const RayFrame f = out.plan.meta.frame();
  const double rays = static_cast<double>(grid.axis[f.u].cells()) * static_cast<double>(grid.axis[f.v].cells());
  const double crossings = out.plan.rays.crossings[f.w];
  out.seconds = (50e-9 * crossings + 5e-9 * rays) / threads;
  out.file_bytes = 1.1 / 8 * crossings + 2000;
  const double facets = 160 * static_cast<double>(out.facets);
  out.memory_bytes = std::min(12e6 + 4e6 * threads + facets, static_cast<double>(options.memory));
  return out;
}

}  // namespace teracell::mesher
