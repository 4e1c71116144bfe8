#include "tests/support/winding.hpp"

#include "store/grid/vec3.hpp"

namespace teracell {

double winding_number(const shapes::Facets& facets, const Vec3& point) {
  double angle = 0;
  for (const mesher::Facet& f : facets) {
    // A. Van Oosterom, J. Strackee, "The Solid Angle of a Plane Triangle" (1983).
    const Vec3 a = f.vertex[0] - point, b = f.vertex[1] - point, c = f.vertex[2] - point;
    const double la = length(a), lb = length(b), lc = length(c);
    angle += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace teracell
