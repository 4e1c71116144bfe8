#include "store/compare/equal_cells.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace teracell::inline store {
namespace {

// The planes of both follow from the same numbers, so there is no need to look at each.
bool same_formula(const Axis& a, const Axis& b) {
  return !a.is_graded() && !b.is_graded() && a.origin() == b.origin() && a.step() == b.step() && a.first() == b.first();
}

}  // namespace

void expect_equal_cells(const GridReader& a, const GridReader& b) {
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: its cells are not those of {}: {}; only grids of equal cells can be compared", b.name(), a.name(), what));
  };
  const Metadata &x = a.meta(), &y = b.meta();
  if (x.units != y.units) fail(fmt::format("expected the unit {}, found {}", x.units, y.units));
  for (int d = 0; d < 3; ++d) {
    const Axis &p = x.grid.axis[d], &q = y.grid.axis[d];
    const int64_t lines = std::min(p.cells(), q.cells());
    for (int64_t i = 0; !same_formula(p, q) && i <= lines; ++i)
      if (p.plane(i) != q.plane(i))
        fail(fmt::format("line {} across {}: expected it at {} {}, found it at {} {}", i, axis_name(d), p.plane(i), x.units, q.plane(i), x.units));
    if (p.cells() != q.cells()) fail(fmt::format("expected {} cells along {}, found {}", p.cells(), axis_name(d), q.cells()));
  }
}

}  // namespace teracell::store
