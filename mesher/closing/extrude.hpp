// Closes a relief: the loops around its edge are extended along a grid axis to beyond the domain and closed there, so that
// everything below the relief (or above, or beside it) is inside. Holes within the relief are capped like those of any surface.
#pragma once
#include <vector>

#include "mesher/closing/caps.hpp"
#include "store/grid/grid.hpp"

namespace teracell::mesher {

// Which loops of a shell are extruded. By winding number: those whose signed area, seen along the axis, has the sign of the
// largest loop's (of equal loops, the one with the smallest vertex). By parity loops have no sign: all loops that lie inside
// no other one. `loops` are as the grid sees them.
std::vector<bool> outer_loops(const std::vector<Loop>& loops, int axis, bool evenodd);

// The coordinates where walls along `axis` end: one below and one above both the grid and the box lo, hi of all vertices.
std::array<double, 2> beyond(int axis, const Grid& grid, const Vec3& lo, const Vec3& hi);

// Adds walls from the loop to its image at coordinate `to` along the axis, two facets per edge, and a fan of facets in that plane.
void extrude_loop(const Loop& loop, int axis, double to, std::vector<Facet>& walls, std::vector<Hole>& holes);

}  // namespace teracell::mesher
