// Pictures to scale: pixels of equal length, whatever the widths of the cells.
#pragma once
#include <cstdint>
#include <vector>

#include "store/grid/grid.hpp"

namespace teracell::server {

// The length of the cells [from, to) of a level along an axis, in units of the grid. REQUIRES: the level has them.
double length_of(const Axis& axis, int level, int64_t from, int64_t to);

// The cell that each of so many equal parts of these cells shows: the one in which its middle lies.
std::vector<int64_t> cells_to_scale(const Axis& axis, int level, int64_t from, int64_t to, int64_t pixels);

}  // namespace teracell::server
