// A slice as viewers of large pictures expect it: a picture in sizes that are halved again and again, with rows counted from the
// top.
//
// Scale s has ceil(width / 2^s) x ceil(height / 2^s) pixels. The pixel (x, y) stands for the 2^s x 2^s cells of level 0 that begin
// at (x, y) 2^s, and shows the cell of level s that contains the first of them. In row y this cell has
// v = (height - 1 - y 2^s) >> s = height(s) - 1 - y. So scale s is the slice of level s with one pixel per cell.
#pragma once
#include <optional>
#include <string_view>

#include "server/parts/picture_parts.hpp"

namespace teracell::server {

struct ScaledSlice {
  const GridReader* reader;
  int axis;
  int64_t index;  // of level 0

  int64_t width(int scale = 0) const;
  int64_t height(int scale = 0) const;
  // The finest scale at which neither side is longer than `pixels`. REQUIRES: pixels >= 1; then the grid has this level.
  int scale_within(int64_t pixels) const;
  // How to make the pixels [x0, x1) x [y0, y1) of a scale as PNG. REQUIRES: they lie in the picture.
  Service::Recipe picture(int scale, int64_t x0, int64_t y0, int64_t x1, int64_t y1) const;
};

// The slice with this index across the axis "x", "y" or "z", if the grid has it.
std::optional<ScaledSlice> slice_at(const GridReader& reader, std::string_view axis, std::string_view index);

}  // namespace teracell::server
