// Closing a surface: the loops of its boundary, each joined to one apex. A surface with its caps has no boundary, so
// the winding number or the parity along every ray is whole, wherever the ray passes; nothing can leak.
#pragma once
#include <vector>

#include "mesher/closure.hpp"
#include "mesher/scene.hpp"

namespace teracell {

// A loop of the boundary, as the grid sees it.
struct Hole {
  Vec3 at;            // the apex of its cap
  uint64_t edges;
  double diameter;    // twice the largest distance of its vertices from the apex
  double cap_area;
};

struct Caps {
  std::vector<Facet> facets;  // in the file's coordinates
  std::vector<Hole> holes;    // the largest first
};

// Cuts the boundary into simple loops: from the smallest vertex along the smallest unused edge, cut whenever a vertex
// repeats. The apex of a loop is the mean of its vertices, summed in lexicographic order, clamped to their box, rounded
// to float32 if `float32`. With `evenodd` edges count once, whatever their direction; else an edge of net count k has k
// facets, the other way round. `matrix` moves the holes, not the facets.
Caps cap_boundary(const std::vector<BoundaryEdge>& edges, bool evenodd, bool float32, const Matrix& matrix);

}  // namespace teracell
