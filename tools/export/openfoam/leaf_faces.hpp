// The faces of a cell of a refined mesh. Between a cell and finer ones there is a face for each of them; a face has its edges' middles as corners
// as well, where finer cells have a point.
#pragma once
#include "tools/export/refined/leaf_points.hpp"

namespace teracell::exports::foam {

struct LeafFace {
  LeafAt beyond;                 // the leaf on the other side; none: a side of the box
  int direction;                 // 0 to 2 upwards along x, y, z, 3 to 5 downwards
  LeafAt smaller;                // of both leaves, the one that has the face as a whole
  bool finer;                    // that is the one beyond. No cell around it is so fine that its edges could have middles: they touch the cell
  int64_t plane;                 // where it lies on its axis
  int axis() const { return direction % 3; }
  bool up() const { return direction < 3; }
};

// Calls f(face) for the faces of a cell, by direction, then by place.
template <class F>
void for_each_face(NearLeaves& near, const LeafAt& cell, F&& f) {
  for (int direction = 0; direction < 6; ++direction) {
    const auto a = static_cast<size_t>(direction % 3), b = (a + 1) % 3, c = (a + 2) % 3;
    const bool up = direction < 3;
    const int64_t plane = up ? cell.hi(a) : cell.lo(a);
    const LeafAt beyond = near.beside(cell, a, up);
    if (!beyond || beyond.level >= cell.level) {
      f(LeafFace{beyond, direction, cell, false, plane});
      continue;
    }
    const auto half_b = cell.half(b), half_c = cell.half(c);
    Index3 next{};
    next[a] = up ? plane : plane - 1;
    for (int k = 0; k < (half_c ? 2 : 1); ++k)
      for (int j = 0; j < (half_b ? 2 : 1); ++j) {
        next[b] = j == 0 ? cell.lo(b) : *half_b, next[c] = k == 0 ? cell.lo(c) : *half_c;
        const LeafAt finer = near.at(next);
        f(LeafFace{finer, direction, finer, true, plane});
      }
  }
}

}  // namespace teracell::exports::foam
