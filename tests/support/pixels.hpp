// The picture that viewers of scaled slices must show, computed from the cells by brute force.
#pragma once
#include "tests/support/png.hpp"
#include "tests/support/served_cells.hpp"

namespace teracell::testing {

// The pixel (x, y) of scale s, counted from the top left, stands for the pixel (x, y) * 2^s of the slice. It has the colour of the
// cell of level s that contains it.
inline Png expected_picture(const ServedCells& served, int axis, int64_t index, int scale) {
  const Grid& grid = served.meta().grid;
  const RayFrame f = RayFrame::along(axis);
  const int64_t width = grid.cells()[static_cast<size_t>(f.u)], height = grid.cells()[static_cast<size_t>(f.v)];
  const auto colors = served.colors(scale);
  const Index3 n = grid.cells(scale);
  Png out{ceil_shift(width, scale), ceil_shift(height, scale), {}};
  for (int64_t y = 0; y < out.height; ++y)
    for (int64_t x = 0; x < out.width; ++x) {
      Index3 cell;
      cell[static_cast<size_t>(f.u)] = (x << scale) >> scale;
      cell[static_cast<size_t>(f.v)] = (height - 1 - (y << scale)) >> scale;
      cell[static_cast<size_t>(f.w)] = index >> scale;
      out.pixels.push_back(colors[static_cast<size_t>((cell[2] * n[1] + cell[1]) * n[0] + cell[0])]);
    }
  return out;
}

// Whether `part` equals the part of `whole` that begins at (x, y).
inline bool shows(const Png& part, const Png& whole, int64_t x, int64_t y) {
  if (x + part.width > whole.width || y + part.height > whole.height) return false;
  for (int64_t r = 0; r < part.height; ++r)
    if (!std::equal(part.pixels.begin() + r * part.width, part.pixels.begin() + (r + 1) * part.width,
                    whole.pixels.begin() + (y + r) * whole.width + x))
      return false;
  return true;
}

// A grid with many cells along x and z.
inline Grid long_grid() { return unit_grid({1100, 3, 531}); }

}  // namespace teracell::testing
