#pragma once
#include <cmath>

#include "mesher/surface/facet.hpp"

namespace teracell::mesher {

// Half of the length of the facet's normal, with one rounding per operation, so that it is the same everywhere.
inline double area(const std::array<Vec3, 3>& p) {
  Vec3 a, b;
  for (int d = 0; d < 3; ++d) a[d] = p[1][d] - p[0][d], b[d] = p[2][d] - p[0][d];
  const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
  return std::sqrt((x * x + y * y) + z * z) / 2;
}
inline double area(const Facet& facet) { return area(facet.vertex); }

}  // namespace teracell::mesher
