#include "mesher/thin/lines.hpp"

namespace teracell::mesher {

Axis plane_axis(const Axis& axis) {
  if (!axis.is_graded()) return Axis::uniform(axis.origin(), axis.step(), axis.first(), axis.cells() + 1, 0);
  std::vector<double> planes = axis.planes();
  const size_t last = planes.size() - 1;
  planes.push_back(planes[last] +
                   (planes[last] - planes[last - 1]));  // needed only as the last cell's upper plane: sample points lie on lower planes
  return Axis::graded(std::move(planes), 0);
}

}  // namespace teracell::mesher
