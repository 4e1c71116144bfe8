// The main job: a scene in, a .tcell file out.
//
//   scene -> facets -> (closed? box? cost?) -> grid -> groups of tiles, several threads:
//   tiles -> crossings -> runs -> chunks of level 0 and 2 -> in order: pyramid above, file
//
// The file depends on the scene, its surfaces, the options axis, thin and chunk_rays, and the version of zstd. It does not depend on
// the number of threads, the memory, the engine or timing.
#pragma once
#include <atomic>
#include <filesystem>
#include <functional>

#include "mesher/report.hpp"
#include "mesher/scene/scene.hpp"
#include "mesher/shards.hpp"

namespace teracell {

struct MeshOptions {
  std::optional<int> axis;           // of the rays; chosen by cost when absent
  std::string engine = "scan";       // engines.hpp; the file is the same
  int threads = 0;                   // 0: as many as the machine has
  uint64_t memory = ~uint64_t{0};    // bytes that the whole run may take, roughly; surfaces that don't fit are spilled
  std::filesystem::path tmp;         // folder for what is spilled; empty: the folder of the output
  std::filesystem::path write_caps;  // file for the caps that close open surfaces; empty: none
  bool thin = false;                 // count what is lost between sample points, for all solids and along all axes
  bool resume = false;               // go on with what a killed run has left, if it has left anything
  double checkpoint_seconds = 1;     // at least so many between two checkpoints
  std::optional<Shard> shard;        // make this part of the grid alone; merge.hpp puts parts together
  uint32_t chunk_rays = 64;          // a chunk has chunk_rays x chunk_rays rays
};

// Called now and then from the thread that called mesh(), with the phase, the share of it that is done, and the cells of the whole grid.
using Progress = std::function<void(const char* phase, double share, double cells)>;

struct MeshReport {
  Report report;            // what the file holds
  std::string json;         // the same, as the file holds it
  RunReport run;
  Scene scene;              // as the report shows it
  size_t caps_written = 0;  // files
  std::vector<std::string> warnings() const;  // those of the report, and what was found by sums that round
};

uint64_t peak_memory_bytes();  // of this process so far

// The name of a part of `output`.
std::filesystem::path part_path(const std::filesystem::path& output, const Shard& shard);

// Writes `output`, or a part of it under its own name, and returns the report; that of a part is empty. Throws Interrupted soon after `stop` is set.
// Whatever is thrown, a file stands under the output's name only if it stood there before.
MeshReport mesh(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, const Progress& progress,
                const std::atomic<bool>& stop);

}  // namespace teracell
