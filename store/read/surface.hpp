// How thick a material is where its surface is, along the surface's normal.
#pragma once
#include "store/read/reader.hpp"

namespace teracell::inline store {

struct Thick {
  uint32_t material;
  Vec3 normal;    // of length 1, out of the material
  Vec3 from, to;  // where the line along the normal enters the material and leaves it
  int64_t cells;  // that it passes through in between
};
// Of the material of a cell of level 0, at a point on its surface. The normal is that of the cells around: it points away from where the material
// is within six cells, so it is as smooth as the surface that the steps of cells stand for, and along an axis where a surface is flat along the
// others; the ends lie on sides of cells. None where the material goes on around the point, or through more than 2^20 cells. Takes time for the cells
// that the line passes through, up to 2^20. Threads may ask at once. REQUIRES: the cell lies in the grid, and the point in the cell or on its sides.
std::optional<Thick> thickness_at(const GridReader& reader, const Index3& cell, const Vec3& at);

}  // namespace teracell::store
