// Caps: each loop of a surface's boundary is joined to an apex. A surface with its caps has no boundary. So the winding
// number, or the parity, returns to zero along every ray, and nothing can leak.
#pragma once
#include <vector>

#include "mesher/closing/boundary.hpp"
#include "mesher/scene/scene.hpp"

namespace teracell::mesher {

// A loop of the boundary, as the grid sees it.
struct Hole {
  Vec3 at;            // the apex of its cap
  Vec3 lo, hi;        // the box of its vertices
  uint64_t edges;
  double diameter;    // twice the largest distance of its vertices from the apex
  double width;       // 4 × area / length of the edge: the diameter of a round hole, twice the gap of a crack
  double cap_area;    // or the area of the floor if the loop is extruded
  double off_plane;   // the largest distance of its vertices from the plane that fits them: 0 for a flat loop
  bool extruded = false;
};

struct Caps {
  std::vector<Facet> facets;  // in the file's coordinates
  std::vector<Hole> holes;
};

// A closed curve through distinct vertices; the last one is joined to the first.
using Loop = std::vector<Vec3>;

// Cuts the boundary of a shell into simple loops. A walk starts at the smallest vertex and takes the smallest unused edge; it is
// cut whenever a vertex repeats. With `evenodd` each edge counts once, in either direction; else an edge with net k lies on k loops.
std::vector<Loop> cut_into_loops(const std::vector<BoundaryEdge>& edges, bool evenodd);

// The mean of the vertices, summed in lexicographic order, clamped to their box, and rounded to float32 if `float32`.
Vec3 apex_of(const Loop& loop, bool float32);
// Joins the loop to its apex. The facets use its edges in reverse.
void cap_loop(const Loop& loop, bool float32, const Matrix& matrix, Caps& out);

// Measures the hole that a loop surrounds. REQUIRES: both are as the grid sees them.
Hole measure_hole(const Loop& loop, const Vec3& apex);

}  // namespace teracell::mesher
