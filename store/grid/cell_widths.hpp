// How wide the cells of an axis are.
#pragma once
#include "store/grid/grid.hpp"

namespace teracell::inline store {

struct CellWidths {
  double smallest, largest;
  double smallest_at;  // its lower plane
  double ratio;        // the largest of two neighbours, at least 1
  double ratio_at;     // the plane between them
};

CellWidths cell_widths(const Axis& axis);

}  // namespace teracell::store
