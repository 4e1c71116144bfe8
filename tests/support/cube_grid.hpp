// Grids of cubic cells.
#pragma once
#include "store/grid/grid.hpp"

namespace teracell {

// So many cells along x, y and z, of this step, from `lo`.
inline Grid uniform_grid(double lo, double step, const Index3& n) {
  const auto axis = [&](int64_t cells) { return Axis::uniform(lo, step, 0, cells, 0.5); };
  return {{axis(n[0]), axis(n[1]), axis(n[2])}};
}
// Cells of width 1, from 0.
inline Grid unit_grid(const Index3& n) { return uniform_grid(0, 1, n); }

// n cells along each axis, of this step, from `lo`.
inline Grid cube_grid_of(double lo, double step, int64_t n) { return uniform_grid(lo, step, {n, n, n}); }
// n cells along each axis, from `lo` to `hi`.
inline Grid cube_grid(double lo, double hi, int64_t n) { return cube_grid_of(lo, (hi - lo) / static_cast<double>(n), n); }

}  // namespace teracell
