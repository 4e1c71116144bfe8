#include "mesher/engines/ray.hpp"

#include "mesher/engines/height.hpp"

namespace teracell {

void cross_ray(const SceneFacet& facet, const Tile& tile, double u, double v, std::vector<uint64_t>& out, uint64_t& exact) {
  const int turn = turn_around_ray(facet.facet, tile.frame, u, v);
  if (turn == 0) return;
  uint32_t cell;
  FacetHeight(facet.facet, tile.frame, *tile.axis).first_cells({&u, 1}, v, &cell, exact);
  out.push_back(Crossing::pack(cell, facet.layer, turn > 0));
}

}  // namespace teracell
