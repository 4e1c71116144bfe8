// What a run would do, without casting a ray: the surfaces are read once, and the grid is decided.
#pragma once
#include <atomic>

#include "mesher/run/mesh_options.hpp"
#include "mesher/run/plan.hpp"

namespace teracell::mesher {

struct DryRun {
  Plan plan;
  uint64_t facets = 0;
  double read_seconds = 0;                               // measured
  double seconds = 0, memory_bytes = 0, file_bytes = 0;  // estimates: of casting with so many threads as asked for, and of the file
};

// Throws what mesh() would throw up to there.
DryRun dry_run(const Scene& scene, const MeshOptions& options, const Progress& progress, const std::atomic<bool>& stop);

}  // namespace teracell::mesher
