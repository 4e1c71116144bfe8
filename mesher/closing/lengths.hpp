// Lengths, in one order of floating-point operations (README.md): nothing else that closes surfaces may compute distances.
// Unlike std::hypot, they are the same on every machine.
#pragma once
#include <algorithm>

#include "store/grid/vec3.hpp"

namespace teracell::mesher {

inline double distance(const Vec3& a, const Vec3& b) { return length(a - b); }

// Makes the box [lo, hi] reach the point.
inline void extend(Vec3& lo, Vec3& hi, const Vec3& p) {
  for (int d = 0; d < 3; ++d) lo[d] = std::min(lo[d], p[d]), hi[d] = std::max(hi[d], p[d]);
}

}  // namespace teracell::mesher
