// The main job: a scene in, a .tcell file out.
//
//   scene -> facets -> (closed? box? cost?) -> grid -> groups of tiles, several threads:
//   tiles -> crossings -> runs -> chunks of level 0 and 2 -> in order: pyramid above, file
//
// The file depends on the scene, its surfaces, the options axis, thin and chunk_rays, and the version of zstd. It does not depend on
// the number of threads, the memory, the engine or timing.
#pragma once
#include <atomic>

#include "mesher/run/mesh_options.hpp"
#include "mesher/run/run_report.hpp"
#include "mesher/scene/scene.hpp"

namespace teracell::mesher {

struct MeshReport {
  Report report;            // what the file holds
  std::string json;         // the same, as the file holds it
  RunReport run;
  Scene scene;              // as the report shows it
  size_t caps_written = 0;  // files
  std::vector<std::string> warnings() const;  // those of the report, and what was found by sums that round
};

// The name of a part of `output`.
std::filesystem::path part_path(const std::filesystem::path& output, const Shard& shard);

// Writes `output`, or a part of it under its own name, and returns the report; that of a part is empty. Throws Interrupted soon after `stop` is set.
// Whatever is thrown, a file stands under the output's name only if it stood there before.
MeshReport mesh(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, const Progress& progress,
                const std::atomic<bool>& stop);

}  // namespace teracell::mesher
