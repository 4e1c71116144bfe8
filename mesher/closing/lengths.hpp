// Lengths, in one order of floating-point operations (README.md): nothing else that closes surfaces may compute distances.
// Unlike std::hypot, they are the same on every machine.
#pragma once
#include <algorithm>
#include <cmath>

#include "store/grid/grid.hpp"

namespace teracell::mesher {

inline double length(const Vec3& d) { return std::sqrt((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]); }
inline Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double distance(const Vec3& a, const Vec3& b) { return length(minus(a, b)); }

// Makes the box [lo, hi] reach the point.
inline void extend(Vec3& lo, Vec3& hi, const Vec3& p) {
  for (int d = 0; d < 3; ++d) lo[d] = std::min(lo[d], p[d]), hi[d] = std::max(hi[d], p[d]);
}

}  // namespace teracell::mesher
