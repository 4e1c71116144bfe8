#include "tests/support/winding.hpp"

namespace teracell {
namespace {

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 cross(const Vec3& a, const Vec3& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

}  // namespace

double winding_number(const shapes::Facets& facets, const Vec3& point) {
  double angle = 0;
  for (const mesher::Facet& f : facets) {
    // A. Van Oosterom, J. Strackee, "The Solid Angle of a Plane Triangle" (1983).
    const Vec3 a = minus(f.vertex[0], point), b = minus(f.vertex[1], point), c = minus(f.vertex[2], point);
    const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
    angle += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace teracell
