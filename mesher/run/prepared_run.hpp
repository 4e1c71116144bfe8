// The beginning of a run, which is the same for all processes that make parts of one grid: the surfaces are read, the grid is decided, and
// solids are closed.
#pragma once
#include <atomic>
#include <chrono>

#include "mesher/bodies/caps_file.hpp"
#include "mesher/bodies/patches.hpp"
#include "mesher/run/mesh_options.hpp"
#include "mesher/run/plan.hpp"
#include "mesher/run/run_report.hpp"

namespace teracell::mesher {

class PreparedRun {
 public:
  // `output` is named when the run is interrupted. `counts`: this process finds what the report says of the surfaces as a
  // whole. Keeps references to `scene`, `progress` and `stop`.
  PreparedRun(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, bool counts, const Progress& progress,
              const std::atomic<bool>& stop);

  // What the bytes of the whole grid depend on, as JSON. A long part is represented by its checksum, because every checkpoint holds all
  // of this.
  std::string identity() const;
  CostMap costs() const;  // REQUIRES: the facets were not handed on
  void progress(const char* phase, double share) const;  // throws Interrupted
  void end_phase(const char* name);
  // The facets of solids, for engines that search all of them. Throws InputError when they are not in memory.
  std::vector<const SceneFacet*> of_solids(const GridFacets* facets) const;
  void commit_caps();
  size_t caps() const { return caps_.size(); }

  const Scene& scene;
  const MeshOptions options;
  const bool counts;
  const int threads;
  const Budget budget;
  Plan plan;
  Bodies bodies;
  std::optional<Patches> patches;
  std::vector<uint8_t> widened;  // bodies, as in rays.hpp
  RunReport run;

 private:
  void check_caps();
  const std::string output_;
  const Progress& progress_;
  const std::atomic<bool>& stop_;
  std::vector<std::unique_ptr<OutputFile>> caps_;
  std::chrono::steady_clock::time_point phase_began_ = std::chrono::steady_clock::now();
};

}  // namespace teracell::mesher
