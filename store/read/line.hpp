// The materials along a straight line through the cells of level 0.
#pragma once
#include "store/read/reader.hpp"

namespace teracell::inline store {

struct LineRun {
  double from, to;  // shares of the line, 0 at its first point and 1 at its last
  uint32_t material;
  int64_t cells;  // that the line passes through, by more than a point
};
// Runs of one material each, from `a` to `b` (coordinates); where the line lies outside the grid there is none. Where it runs along a
// plane between cells, those above the plane count. Takes time for the cells that the line passes through. Threads may ask at once.
// REQUIRES: a and b are finite and differ.
std::vector<LineRun> read_line(const GridReader& reader, const Vec3& a, const Vec3& b);

}  // namespace teracell::store
