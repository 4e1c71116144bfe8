// Traditional ray casting: every ray against every facet of the scene, rays times facets in time. There to be measured
// against, and to be checked against: nothing is simpler.
//
// The side of an edge is an orientation test without division, as in T. Ma, T. Ma, L. Hao, "Large-Scale Finite
// Difference Grid Generation and Visualization Method Based on Ray Casting Algorithm" (MSAM 2020).
#include "mesher/engines/brute.hpp"

#include "mesher/engines/ray.hpp"

namespace teracell {

void BruteEngine::cast(const Tile& tile, std::span<const SceneFacet* const>, Crossings& out) {
  out.begin.assign(1, 0);
  out.all.clear();
  for (const double v : tile.v) {
    for (const double u : tile.u) {
      for (const SceneFacet* facet : *scene_) cross_ray(*facet, tile, u, v, out.all, exact_decisions_);
      check_crossings(tile, out.all.size());
      out.begin.push_back(static_cast<uint32_t>(out.all.size()));
    }
  }
}

}  // namespace teracell
