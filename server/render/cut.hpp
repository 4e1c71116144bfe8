// What is cut away from a grid before it is drawn.
#pragma once
#include <vector>

#include "server/render/camera.hpp"

namespace teracell::server {

// The points p with normal . p >= offset.
struct HalfSpace {
  Vec3 normal;
  double offset;
  bool has(const Vec3& p) const { return dot(normal, p) >= offset; }
};

// The points that lie in all of these: a half-space, a corner.
using Cut = std::vector<HalfSpace>;
using Cuts = std::vector<Cut>;

inline bool is_cut(const Cuts& cuts, const Vec3& p) {
  for (const Cut& cut : cuts) {
    bool inside = true;
    for (const HalfSpace& half : cut) inside = inside && half.has(p);
    if (inside) return true;
  }
  return false;
}

// The planes of all cuts have numbers: those of the first cut come first. REQUIRES: there is such a plane.
inline const HalfSpace& plane_of(const Cuts& cuts, int number) {
  size_t i = 0;
  for (; number >= static_cast<int>(cuts[i].size()); ++i) number -= static_cast<int>(cuts[i].size());
  return cuts[i][static_cast<size_t>(number)];
}

}  // namespace teracell::server
