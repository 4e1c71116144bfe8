// Sub-samples: the sample points of a grid with several times as many cells along an axis.
#pragma once
#include <cstdint>

#include "store/grid/grid.hpp"

namespace teracell::mesher {

// The axis of the sub-samples of the cells [from, to), `samples` for each of them; each lies in the middle of its part of the cell. Of a
// uniform axis it takes no memory, of a graded one 8 bytes per sub-sample. Throws UsageError unless they ascend strictly.
Axis sub_axis(const Axis& axis, uint32_t samples, int64_t from, int64_t to);

// Throws UsageError, naming the axis, unless all sub-samples of the grid ascend strictly.
void check_sub_samples(const Grid& grid, const std::array<uint32_t, 3>& samples);

}  // namespace teracell::mesher
