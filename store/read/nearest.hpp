// A cell near a place that has one of some labels: where to look first.
#pragma once
#include "store/read/reader.hpp"

namespace teracell::inline store {

// The cell of level 0 nearest to `to` with one of these labels (by label); none when no cell has one. A distance along an axis counts as a share
// of the side of the box around all such cells: of a wide, flat hall the stands at the sides are nearer to its middle than the floor below,
// and a slice through them shows more. Another cell may be nearer by an eighth: where many are nearly as near, not all are looked at. Goes down
// the pyramid, and reads few chunks. Threads may ask at once. REQUIRES: `to` lies in the grid.
std::optional<Index3> read_nearest(const GridReader& reader, const std::vector<bool>& labels, const Index3& to);

}  // namespace teracell::store
