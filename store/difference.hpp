// Which cells of two grids have different materials, from runs: cells are never expanded. The grids have equal cells, but their rays
// may lie along different axes, and their chunks may be of different sizes.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "store/reader.hpp"

namespace teracell {

// The cells that have one material in the first grid and another one in the second.
struct Change {
  std::string from, to;  // names
  unsigned __int128 cells = 0;
  Box box;
};

struct Difference {
  unsigned __int128 cells = 0, same = 0;  // all, and those whose materials have the same name
  std::vector<Change> changes;            // the most cells first; among equals by their names
};

struct DifferenceOptions {
  int threads = 1;
  size_t memory = size_t{256} << 20;  // for runs of the second grid
  size_t most_changes = size_t{1} << 20;  // pairs of materials; a file holds fewer
  std::filesystem::path output;       // a .tcell file with the changes as labels; empty: none
  std::filesystem::path folder;       // for temporary files; empty: that of the output
};

// Exact, and the same for any threads, chunks, axes and memory. progress(phase, share) may throw to stop. Throws InputError unless the
// grids have equal cells and at most so many pairs of materials differ. When it returns, the output is durable. Threads may not change `a` or `b`
// meanwhile, but may read them. Where chunks of both grids lie alike, those of the same length, checksum and statistics are taken for equal without
// being read.
Difference find_difference(const GridReader& a, const GridReader& b, const DifferenceOptions& options,
                           const std::function<void(const char*, double)>& progress);

}  // namespace teracell
