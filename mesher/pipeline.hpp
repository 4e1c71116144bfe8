// The main job: a scene in, a .tcell file out.
//
//   scene -> facets -> (closed? box? cost?) -> grid -> groups of tiles, several threads:
//   tiles -> crossings -> runs -> chunks of level 0 and 2 -> in order: pyramid above, file
//
// The file depends on the scene alone: neither on the number of threads nor on timing.
#pragma once
#include <atomic>
#include <filesystem>
#include <functional>

#include "mesher/report.hpp"
#include "mesher/scene/scene.hpp"

namespace teracell {

struct MeshOptions {
  std::optional<int> axis;           // of the rays; chosen by cost when absent
  std::string engine = "scan";       // engines.hpp; the file is the same
  int threads = 0;                   // 0: as many as the machine has
  uint64_t memory = ~uint64_t{0};    // bytes that the whole run may take, roughly; what doesn't fit is spilled
  std::filesystem::path tmp;         // folder for that; empty: the output's
  std::filesystem::path write_caps;  // file for the caps that close open surfaces; empty: none
  bool thin = false;                 // count what is lost between sample points, of all solids along all axes
  bool resume = false;               // go on with what a killed run has left, if there is something
  double checkpoint_seconds = 1;     // at least, between two of them
  uint32_t chunk_rays = 64;          // a chunk has chunk_rays x chunk_rays rays
};

// Called now and then, from the thread that called mesh(): the phase, its share of 1, and the cells of the whole grid.
using Progress = std::function<void(const char* phase, double share, double cells)>;

struct MeshReport {
  Report report;            // what the file holds
  std::string json;         // the same, as the file holds it
  RunReport run;
  size_t caps_written = 0;  // files
  std::vector<std::string> warnings() const;  // those of the report, and what was found by sums that round
};

// Writes `output` and returns the report. Stops soon after `stop` is set, with Interrupted. Whatever is thrown, nothing
// stands under the output's name that was not there before.
MeshReport mesh(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options,
                const Progress& progress, const std::atomic<bool>& stop);

}  // namespace teracell
