// The cells that a plane meets, at any angle, as a picture of it. Slices across an axis are in slice.hpp.
#pragma once
#include "store/read/slice.hpp"

namespace teracell::inline store {

// A picture of a plane, and the part of it that is asked for: its pixels i0 <= i < i1, j0 <= j < j1, where i counts to the right and j upwards.
// A pixel has the cell, of `level`, in which its middle lies.
struct PlaneView {
  Vec3 corner{};           // of pixel (0, 0): its lower left one, in coordinates
  Vec3 right{}, up{};      // from a pixel to its neighbours
  int64_t i0 = 0, j0 = 0, i1 = 0, j1 = 0;
  int level = 0;

  // The coordinate, along an axis, of the middle of a pixel.
  double middle(size_t axis, int64_t i, int64_t j) const {
    return corner[axis] + (static_cast<double>(j) + 0.5) * up[axis] + (static_cast<double>(i) + 0.5) * right[axis];
  }
};

// Calls row(j, values) for every row of pixels, from the top (j1 - 1) down or from j0 up. What lies outside the grid has the value `outside`. Decodes
// on `threads` threads, which call `value` at once. Memory: about `held` pixels of two bytes, but at least a row, and per thread a chunk.
// Throws UsageError for a level that is not there. REQUIRES: the view is not empty and its numbers are finite.
void for_each_plane_row(const GridReader& reader, const PlaneView& view, const SetValue& value, uint16_t outside, bool top_down, int threads,
                        const RowSink& row, int64_t held = kHeldCells);

}  // namespace teracell::store
