// One ray against one facet: the step that the engines `brute` and `tree` share.
#pragma once
#include "mesher/engine.hpp"
#include "mesher/predicates.hpp"

namespace teracell {

// How the projected facet winds around the ray through (u, v): +1 to the left, -1 to the right, 0 when they don't cross.
// Divides nothing: an edge counts when the row v meets it, its lower end included, and it passes right of the ray.
inline int turn_around_ray(const Facet& facet, const Frame& f, double u, double v) {
  int turn = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &a = facet.vertex[i], &b = facet.vertex[(i + 1) % 3];
    const bool rises = a[f.v] <= v, falls = b[f.v] <= v;  // if not both, or neither
    if (rises == falls) continue;
    const Vec3 &lo = rises ? a : b, &hi = rises ? b : a;
    if (!right_of_edge(lo[f.u], lo[f.v], hi[f.u], hi[f.v], u, v)) turn += rises ? 1 : -1;
  }
  return turn;
}

// Adds the crossing of ray (u, v) of the tile with the facet, if there is one. Adds to `exact` as FacetHeight does.
void cross_ray(const SceneFacet& facet, const Tile& tile, double u, double v, std::vector<uint64_t>& out, uint64_t& exact);

}  // namespace teracell
