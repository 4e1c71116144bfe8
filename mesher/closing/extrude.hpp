// Closing a relief: the loops around its edge are drawn out along a grid axis to beyond the domain and closed there, so
// that all below (or above, or beside) the relief is solid. Holes within it are capped like those of any surface.
#pragma once
#include <vector>

#include "mesher/closing/caps.hpp"
#include "store/grid.hpp"

namespace teracell {

// Which loops of a shell go: those whose signed area across the axis has the sign of the largest one's (of equal ones that
// with the smallest vertex); where crossings are counted loops have no sign, and all go but those inside another one.
// `loops` as the grid sees them.
std::vector<bool> outer_loops(const std::vector<Loop>& loops, int axis, bool evenodd);

// The coordinate below and above the grid and the box lo, hi of all vertices where walls along `axis` end.
std::array<double, 2> beyond(int axis, const Grid& grid, const Vec3& lo, const Vec3& hi);

// Walls from the loop to its image at coordinate `to`, two facets an edge, and a cone in that plane.
void extrude_loop(const Loop& loop, int axis, double to, std::vector<Facet>& walls, std::vector<Hole>& holes);

}  // namespace teracell
