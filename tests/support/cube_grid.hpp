// Grids of cubic cells over a cube.
#pragma once
#include "store/grid/grid.hpp"

namespace teracell {

// n cells along each axis, of this step, from `lo`.
inline Grid cube_grid_of(double lo, double step, int64_t n) {
  const Axis axis = Axis::uniform(lo, step, 0, n, 0.5);
  return {{axis, axis, axis}};
}

// n cells along each axis, from `lo` to `hi`.
inline Grid cube_grid(double lo, double hi, int64_t n) { return cube_grid_of(lo, (hi - lo) / static_cast<double>(n), n); }

}  // namespace teracell
