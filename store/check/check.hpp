// Looks through the cells of a grid, and through the report in its file, for what its owner wants to know: thin walls, cells that hang together
// with nothing, bodies that the domain cuts, and what the mesher found. One pass over the rays, in memory that does not grow with the cells.
#pragma once
#include <functional>

#include "store/check/finding.hpp"
#include "store/check/options.hpp"
#include "store/read/reader.hpp"

namespace teracell::inline store {

// Bytes of chunks that a reader should keep for it: those of three rows of chunks are used again.
inline constexpr size_t kCheckKeeps = size_t{160} << 20;

// `progress` is called with the share of the rays that are done; what it throws ends the work.
Findings check(const GridReader& reader, const CheckOptions& options, const std::function<void(double share)>& progress);

}  // namespace teracell::store
