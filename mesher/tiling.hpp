// Facets -> tiles of rays. The rays are a tree: a node of level 2k has 4 x 4 children, down to the chunks of level 0,
// and is itself the place of one chunk of level 2k of the pyramid. Walking the tree depth first hands every tile its
// facets, and completes the chunks of all levels one after another, with memory for one path only: facet numbers that
// are passed down, never a table of tiles. (Rejected: a list of facets for every tile. Twelve facets of a box over
// 10^5 x 10^5 rays would need gigabytes.)
#pragma once
#include <optional>
#include <vector>

#include "mesher/engine.hpp"
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
  Tiling(const std::vector<SceneFacet>& facets, const Metadata& meta);
  uint64_t units() const { return units_; }
  // The units in the order of the tree; rays without facets included.
  std::optional<Unit> next();
  // The facets of the unit that may meet each of its chunks, chunk (u, v) at v * 4 + u; the lowest along the rays first.
  std::array<std::vector<const SceneFacet*>, 16> split(const Unit& unit) const;

 private:
  struct Rays {  // that a facet may meet: [u0, u1) x [v0, v1)
    uint32_t u0, u1, v0, v1;
  };
  struct Node {
    int depth;  // 0 is a unit
    uint32_t cu, cv;
    std::vector<uint32_t> facets;
  };
  void push_children(Node node);

  const std::vector<SceneFacet>& facets_;
  LevelShape shape_;
  int frame_w_;
  std::vector<Rays> rays_;
  std::vector<Node> path_;
  uint32_t units_u_, units_v_;
  uint64_t units_;
};

}  // namespace teracell
