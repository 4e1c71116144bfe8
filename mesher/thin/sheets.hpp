// Sheets: surfaces that own the cells that they pass through. A sheet owns a cell when the line through the cell's sample point
// along x, y or z crosses it between the cell's planes on that axis. So of two neighbouring cells on different sides of a sheet,
// at least one is the sheet's, and no path through faces of cells passes a closed sheet.
//
// The planes of an axis are the sample points of another axis (plane_axis). So the question is the one that engines answer:
// which plane is the first one above the facet? Ties are decided by the same rule as for cells.
#pragma once
#include "mesher/thin/lines.hpp"
#include "mesher/thin/marks.hpp"
#include "mesher/thin/tally.hpp"

namespace teracell::mesher {

// Not thread-safe.
class Sheets {
 public:
  // Keeps a reference to the grid.
  Sheets(const Grid& grid, int ray_axis);
  Sheets(const Sheets&) = delete;
  // Marks the cells of a tile, which is as long as the grid along the rays. `facets` are those of sheets that may lie in it or
  // beside it. Tallies the lines that cross a sheet on the domain's lower side: these cells lie beyond it.
  void mark(const Box& tile, std::span<const SceneFacet* const> facets, Marks& marks, Tallies& tallies);
  uint64_t exact_decisions() const { return exact_decisions_; }

 private:
  void mark_along(int axis, const Box& tile, const SceneFacet& facet, Marks& marks, Tallies& tallies);
  void tally_lower_side(int axis, const Index3& cell, const SceneFacet& facet, Tallies& tallies) const;

  const Grid& grid_;
  const RayFrame rays_;
  const std::array<Axis, 3> planes_;
  std::array<FacetLines, 3> lines_;
  uint64_t exact_decisions_ = 0;
};

}  // namespace teracell::mesher
