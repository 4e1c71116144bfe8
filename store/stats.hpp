// How many cells of each material a box has, how large they are and where they lie. Threads may ask at once.
#pragma once
#include "store/reader.hpp"

namespace teracell {

// Exact counts of level 0 in `box`.
struct MaterialStats {
  unsigned __int128 cells = 0;
  double volume = 0;
  Box box;  // empty when there is no cell
};
// By material id. A chunk that lies in the box as a whole is not decoded: the index says enough of it, unless an axis is
// graded and the cells of a label don't fill a box. Throws UsageError unless the box lies in the grid.
std::vector<MaterialStats> read_stats(const GridReader& reader, const Box& box);

}  // namespace teracell
