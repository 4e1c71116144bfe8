// The cell nearest to a place that has something: where to look first. It is looked for from the top of the pyramid down, the nearest coarse cell
// first. Threads may ask at once.
#pragma once
#include <functional>

#include "store/read/reader.hpp"

namespace teracell::inline store {

struct Nearest {
  Index3 to{0, 0, 0};
  Box box;                           // of the cells that may be found. REQUIRES: it is not empty
  std::array<double, 3> width{1, 1, 1};  // of a cell, which distances count in
  double slack = 0;  // what is found may be farther than the nearest by this share: where many are nearly as near, few are looked at
  // Whether a cell of a level has it. REQUIRES: what a cell has, the one above it has as well.
  std::function<bool(int level, const Index3& cell)> has;
};
// None where there is none, or where it would have to be looked for in more than kMostOpen coarse cells at once. Throws what has() and Wanted throw.
inline constexpr size_t kMostOpen = size_t{1} << 20;
std::optional<Index3> nearest_cell(const Grid& grid, const Nearest& what);

// The box around all cells with one of these labels (by label), and the one of them that is nearest to a place, the middle of the box by default.
// None where there is none that can be read, or none is found soon (see above). A distance along an axis counts as a share of the side of the box
// around all such cells: of a wide, flat hall the stands at the sides are nearer to its middle than the floor below, and a slice through them shows
// more. Another cell may be nearer by an eighth.
struct BoxAndNearest {
  Box box;  // empty when there is no cell
  std::optional<Index3> cell;
};
BoxAndNearest read_nearest(const GridReader& reader, const std::vector<bool>& labels, std::optional<Index3> to = std::nullopt);

}  // namespace teracell::store
