// Facets -> tiles of rays. The rays are a tree: a node of level 2k has 4 x 4 children, down to the chunks of level 0,
// and is itself the place of one chunk of level 2k of the pyramid. Walking the tree depth first hands every tile its
// facets, and completes the chunks of all levels one after another, with memory for one path only: facet numbers that
// are passed down, never a table of tiles. (Rejected: a list of facets for every tile. Twelve facets of a box over
// 10^5 x 10^5 rays would need gigabytes.)
#pragma once
#include <optional>
#include <vector>

#include "mesher/facet_store.hpp"
#include "store/format.hpp"

namespace teracell {

// 4 x 4 chunks of level 0 (less at the grid's edge), one chunk of level 2: what a worker takes.
struct Unit {
  uint32_t cu, cv;               // its place, in units
  std::vector<uint32_t> facets;  // numbers of those that may meet its rays
};

// next() is not thread-safe; split() may run on any thread, also while next() runs.
class Tiling {
 public:
  // Keeps references to both.
  Tiling(const FacetStore& facets, const Metadata& meta);
  uint64_t units() const { return units_; }
  // The units in the order of the tree; rays without facets included.
  std::optional<Unit> next();
  // The facets of the unit that may meet each chunk of a row of its 4 x 4; the lowest along the rays come first, roughly.
  std::array<std::vector<const SceneFacet*>, 4> split(const Unit& unit, uint32_t row) const;

 private:
  struct Rays {  // that a facet may meet: [u0, u1) x [v0, v1)
    uint32_t u0, u1, v0, v1;
  };
  // Calls f(child, facet) for all of a node's 4 x 4 children, of `size` rays, in the rows [first_row, last_row], that a facet may meet.
  template <class F>
  void bin(const std::vector<uint32_t>& facets, uint32_t cu, uint32_t cv, uint32_t size, uint32_t first_row, uint32_t last_row, F&& f) const;
  struct Node {
    int depth;  // 0 is a unit
    uint32_t cu, cv;
    std::vector<uint32_t> facets;
  };
  void push_children(Node node);

  const FacetStore& facets_;
  LevelShape shape_;
  std::vector<Rays> rays_;
  std::vector<Node> path_;
  uint32_t units_u_, units_v_;
  uint64_t units_;
};

}  // namespace teracell
