// What whoever meshes asks for beside the scene.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "mesher/surface/read_options.hpp"
#include "mesher/tiles/shards.hpp"
#include "store/channels/mixed_cells.hpp"

namespace teracell::mesher {

struct MeshOptions {
  std::optional<int> axis;           // of the rays; chosen by cost when absent
  std::string engine = "scan";       // engines.hpp; the file is the same
  int threads = 0;                   // 0: as many as the machine has
  bool count_aside = false;          // what is counted of the surfaces has a thread of its own, even if `threads` is 1
  uint64_t memory = ~uint64_t{0};    // bytes that the whole run may take, roughly; surfaces that don't fit are spilled
  std::filesystem::path tmp;         // folder for what is spilled; empty: the folder of the output
  std::filesystem::path write_caps;  // file for the caps that close open surfaces; empty: none. Of parts, the first writes it
  bool thin = false;                 // count what is lost between sample points, for all solids and along all axes
  std::optional<Subdivision> fractions;  // count sub-samples of mixed cells, and keep the counts in the file
  bool links = false;                // find where labels change between neighbouring sample points, and keep that in the file
  bool resume = false;               // go on with what a killed run has left, if it has left anything
  double checkpoint_seconds = 1;     // at least so many between two checkpoints
  std::optional<Shard> shard;        // make this part of the grid alone; merge.hpp puts parts together
  CadOptions cad;                    // what the CAD kernel may take; deflection and angle are the scene's
  uint32_t chunk_rays = 64;          // a chunk has chunk_rays x chunk_rays rays
};

// Called now and then from the thread that called mesh(), with the phase, the share of it that is done, and the cells of the whole grid.
using Progress = std::function<void(const char* phase, double share, double cells)>;

}  // namespace teracell::mesher
