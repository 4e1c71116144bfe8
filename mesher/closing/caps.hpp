// Closing a surface: the loops of its boundary, each joined to one apex. A surface with its caps has no boundary, so
// the winding number or the parity along every ray is whole, wherever the ray passes; nothing can leak.
#pragma once
#include <vector>

#include "mesher/closing/boundary.hpp"
#include "mesher/scene/scene.hpp"

namespace teracell {

// A loop of the boundary, as the grid sees it.
struct Hole {
  Vec3 at;            // the apex of its cap
  Vec3 lo, hi;        // the box of its vertices
  uint64_t edges;
  double diameter;    // twice the largest distance of its vertices from the apex
  double width;       // four times its area by its length: the diameter of a round hole, twice the gap of a crack
  double cap_area;    // where it is extruded that of its floor
  bool extruded = false;
};

struct Caps {
  std::vector<Facet> facets;  // in the file's coordinates
  std::vector<Hole> holes;
};

// A closed curve through different vertices; the last one is joined to the first.
using Loop = std::vector<Vec3>;

// Cuts the boundary of a shell into simple loops: from the smallest vertex along the smallest unused edge, cut whenever a
// vertex repeats. With `evenodd` edges count once, whatever their direction; else an edge of net count k lies on k loops.
std::vector<Loop> cut_into_loops(const std::vector<BoundaryEdge>& edges, bool evenodd);

// Joins the loop to its apex: the mean of its vertices, summed in lexicographic order, clamped to their box, rounded to
// float32 if `float32`. The facets run the other way round than the loop.
Vec3 apex_of(const Loop& loop, bool float32);
void cap_loop(const Loop& loop, bool float32, const Matrix& matrix, Caps& out);

// What a loop and its apex are to the grid, both given as the grid sees them.
Hole measure_hole(const Loop& loop, const Vec3& apex);

}  // namespace teracell
