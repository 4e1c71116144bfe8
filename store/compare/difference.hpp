// Which cells of two grids have different materials, from runs: cells are never expanded. The grids have equal cells, but their rays
// may lie along different axes, and their chunks may be of different sizes.
#pragma once
#include "store/compare/difference_counts.hpp"

namespace teracell::inline store {

// Exact, and the same for any threads, chunks, axes and memory. progress(phase, share) may throw to stop. Throws InputError unless the
// grids have equal cells and at most so many pairs of materials differ. When it returns, the output is durable. Threads may not change `a` or `b`
// meanwhile, but may read them. Where chunks of both grids lie alike, those of the same length, checksum and statistics are taken for equal without
// being read.
Difference find_difference(const GridReader& a, const GridReader& b, const DifferenceOptions& options,
                           const std::function<void(const char*, double)>& progress);

}  // namespace teracell::store
