#include "mesher/thin/sheets.hpp"

#include "mesher/closing/closing.hpp"
#include "mesher/engines/predicates.hpp"

namespace teracell::mesher {

Sheets::Sheets(const Grid& grid, int ray_axis)
    : grid_(grid),
      rays_(RayFrame::along(ray_axis)),
      planes_{plane_axis(grid.axis[0]), plane_axis(grid.axis[1]), plane_axis(grid.axis[2])},
      lines_{FacetLines{grid, 0, planes_[0]}, FacetLines{grid, 1, planes_[1]}, FacetLines{grid, 2, planes_[2]}} {}

void Sheets::mark(const Box& tile, std::span<const SceneFacet* const> facets, Marks& marks, Tallies& tallies) {
  for (const SceneFacet* facet : facets)
    for (int axis = 0; axis < 3; ++axis) mark_along(axis, tile, *facet, marks, tallies);
}

void Sheets::mark_along(int axis, const Box& tile, const SceneFacet& facet, Marks& marks, Tallies& tallies) {
  const auto& [a, b, c] = facet.facet.vertex;
  const double lower_side = grid_.axis[axis].min();
  const bool touches = tile.lo[axis] == 0 && std::min(std::min(a[axis], b[axis]), c[axis]) <= lower_side &&
                       std::max(std::max(a[axis], b[axis]), c[axis]) >= lower_side;
  const int along = lines_[axis].frame().u;
  const auto nu = static_cast<uint32_t>(tile.hi[rays_.u] - tile.lo[rays_.u]);
  lines_[axis].cross(facet.facet, tile, exact_decisions_, [&](Index3 cell, std::span<const uint32_t> above, bool) {
    for (size_t i = 0; i < above.size();) {
      // The cell below the first plane above the facet holds the crossing. Handles as many lines at once as possible.
      const uint32_t plane = above[i];
      const size_t first = i;
      while (i < above.size() && above[i] == plane && (i == first || along == rays_.w)) ++i;
      const auto count = static_cast<int64_t>(i - first);
      cell[axis] = int64_t{plane} - 1;
      if (cell[axis] >= tile.lo[axis] && cell[axis] < tile.hi[axis]) {
        const auto ray = static_cast<uint32_t>((cell[rays_.v] - tile.lo[rays_.v]) * nu + cell[rays_.u] - tile.lo[rays_.u]);
        const auto w = static_cast<uint32_t>(cell[rays_.w]);
        marks.add(ray, facet.layer, w, w + static_cast<uint32_t>(along == rays_.w ? count : 1));
      } else if (touches && plane == 0) {
        for (Index3 at = cell; at[along] < cell[along] + count; ++at[along]) tally_lower_side(axis, at, facet, tallies);
      }
      cell[along] += count;
    }
  });
}

void Sheets::tally_lower_side(int axis, const Index3& cell, const SceneFacet& facet, Tallies& tallies) const {
  Vec3 p;
  Index3 at = cell;
  at[axis] = 0;
  for (int d = 0; d < 3; ++d) p[d] = d == axis ? grid_.axis[d].min() : grid_.axis[d].centre(cell[d]);
  if (orient3d(facet.facet, p) == 0)
    tallies.add({TallyKey::What::kLowerSide, body_of_layer(facet.layer), static_cast<uint8_t>(axis)}, {1, 0, 0, 0, at});
}

}  // namespace teracell::mesher
