// The levels of the leaves in a slice, for pictures of any scale.
#pragma once
#include "store/read/slice.hpp"
#include "store/refine/leaves.hpp"

namespace teracell::inline store {

inline constexpr uint8_t kFiner = 255;

// The level-0 cells of a slice of any level.
Box cells_below(const SliceView& view);

// For each cell of a view's level, v0 first: the level of the leaf that holds it, or kFiner if several leaves do. REQUIRES: the leaves are prepared
// for cells_below(view).
std::vector<uint8_t> leaf_levels(const Leaves& leaves, const SliceView& view);

}  // namespace teracell::store
