// Ray casting with a search tree over the facets. See tree.cpp.
#pragma once
#include <array>

#include "mesher/engines/engine.hpp"

namespace teracell::mesher {

// Finds the facets whose projected boxes contain a ray. Immutable; threads may share it.
class FacetTree {
 public:
  // Keeps the pointers, not the span: the facets must outlive the tree.
  FacetTree(std::span<const SceneFacet* const> facets, const RayFrame& frame);

  // Calls f(facet) for every facet whose box contains (u, v), and for a few others.
  template <class F>
  void search(double u, double v, F&& f) const {
    for (size_t n = 0; n < nodes_.size();) {
      const Node& node = nodes_[n];
      if (u < node.limit[0] || u > node.limit[1] || v < node.limit[2] || v > node.limit[3]) {
        n = node.skip;
        continue;
      }
      if (++n < node.skip) continue;  // its first child
      for (uint32_t i = node.first; i < node.last; ++i) f(*facets_[i]);
    }
  }

 private:
  struct Node {
    std::array<double, 4> limit;  // the least u_min, the greatest u_max, the least v_min, the greatest v_max of its facets
    uint32_t skip;                // the node that follows all nodes below this one; for a leaf, the next node
    uint32_t first, last;         // its facets
  };
  struct Point {  // a facet as a point in four dimensions: its projected box u_min, u_max, v_min, v_max
    std::array<double, 4> at;
    const SceneFacet* facet;
  };
  void build(std::span<Point> points, int dimension);

  std::vector<Node> nodes_;  // in depth-first order
  std::vector<const SceneFacet*> facets_;
};

}  // namespace teracell::mesher
