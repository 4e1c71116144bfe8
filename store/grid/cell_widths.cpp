#include "store/grid/cell_widths.hpp"

#include <algorithm>

namespace teracell::inline store {

CellWidths cell_widths(const Axis& axis) {
  if (!axis.is_graded()) return {axis.step(), axis.step(), axis.min(), 1, axis.min()};
  const std::vector<double>& p = axis.planes();
  double before = p[1] - p[0];
  CellWidths out{before, before, p[0], 1, p[0]};
  for (size_t i = 1; i + 1 < p.size(); ++i) {
    const double width = p[i + 1] - p[i];
    if (width < out.smallest) out.smallest = width, out.smallest_at = p[i];
    out.largest = std::max(out.largest, width);
    if (const double ratio = std::max(width / before, before / width); ratio > out.ratio) out.ratio = ratio, out.ratio_at = p[i];
    before = width;
  }
  return out;
}

}  // namespace teracell::store
