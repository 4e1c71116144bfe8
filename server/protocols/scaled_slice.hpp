// A slice as viewers of large pictures know it: a picture that comes in halved sizes, its rows counted from the top.
//
// Scale s has ceil(width / 2^s) x ceil(height / 2^s) pixels. A pixel stands for the cells of level 0 from its place, times
// 2^s, on; it shows the cell of level s that holds the first of them: for row y that is (height - 1 - y 2^s) >> s, which is
// height(s) - 1 - y. So a scale is nothing but the level's slice, a cell a pixel.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "server/tiles.hpp"

namespace teracell {

struct ScaledSlice {
  const GridReader* reader;
  int axis;
  int64_t index;  // of level 0

  int64_t width(int scale = 0) const;
  int64_t height(int scale = 0) const;
  // The scale at which neither side is longer than `pixels`. It is a level of the grid: that of one pixel at the most.
  int scale_within(int64_t pixels) const;
  // The pixels [x0, x1) x [y0, y1) of a scale as PNG. REQUIRES: they lie in it.
  std::string png(int scale, int64_t x0, int64_t y0, int64_t x1, int64_t y1) const;
};

// The slice that "x", "y" or "z" and an index name, if the grid has it.
std::optional<ScaledSlice> slice_at(const GridReader& reader, std::string_view axis, std::string_view index);

}  // namespace teracell
