// The test of one ray against one facet, which the engines `brute` and `tree` share.
#pragma once
#include "mesher/engines/engine.hpp"
#include "mesher/engines/height.hpp"
#include "mesher/engines/predicates.hpp"

namespace teracell::mesher {

// How the projected facet turns around the ray through (u, v): +1 to the left, -1 to the right, 0 when they don't cross. There is
// no division. An edge counts when the row v meets it, its lower end included, and the edge passes on the right of the ray.
inline int turn_around_ray(const Facet& facet, const RayFrame& f, double u, double v) {
  const auto& p = facet.vertex;
  const bool below[3] = {p[0][f.v] <= v, p[1][f.v] <= v, p[2][f.v] <= v};
  if (below[0] == below[1] && below[1] == below[2]) return 0;
  int turn = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (below[i] == below[j]) continue;
    const Vec3 &lo = below[i] ? p[i] : p[j], &hi = below[i] ? p[j] : p[i];
    if (!right_of_edge(lo[f.u], lo[f.v], hi[f.u], hi[f.v], u, v)) turn += below[i] ? 1 : -1;
  }
  return turn;
}

// Appends the crossing of the ray (u, v) with the facet, if they cross. Adds to `exact` how often the exact predicate was called.
inline void cross_ray(const SceneFacet& facet, const Tile& tile, double u, double v, std::vector<uint64_t>& out, uint64_t& exact) {
  const int turn = turn_around_ray(facet.facet, tile.frame, u, v);
  if (turn == 0) return;
  uint32_t cell;
  FacetHeight(facet.facet, tile.frame, *tile.axis).first_cells({&u, 1}, v, &cell, exact);
  out.push_back(Crossing::pack(cell, facet.layer, turn > 0));
}

}  // namespace teracell::mesher
