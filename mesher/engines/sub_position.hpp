// Sub-positions: points between neighbouring sample points, q(k) = c(i) + (k / kSubPositions) * (c(i + 1) - c(i)).
#pragma once
#include "store/grid/grid.hpp"

namespace teracell::mesher {

inline constexpr uint32_t kSubPositions = 65536;
inline double sub_position(const Axis& axis, int64_t cell, uint32_t k) {
  const double lower = axis.centre(cell), upper = axis.centre(cell + 1);
  return k == kSubPositions ? upper : lower + (k / static_cast<double>(kSubPositions)) * (upper - lower);
}

}  // namespace teracell::mesher
