// Cuts a grid into parts that take about the same time: stretches of the tree of rays (pyramid.hpp). What a part holds depends on the
// scene, the axis of the rays, and the number of parts alone, so that parts can be made anywhere, and again.
#pragma once
#include <span>
#include <string>

#include "mesher/surface/facet.hpp"
#include "mesher/tiles/rays.hpp"

namespace teracell::mesher {

struct Shard {
  uint32_t number = 0, of = 1;  // [0, of)
  std::string name() const;     // "shard-3-of-8"
};

// Estimates what casting costs, by nodes of the tree, and what part 0 has to do besides. In whole numbers, so that the sums do not depend
// on the order of a body's facets.
class CostMap {
 public:
  // Keeps references to the axes of `meta`; `widened` bodies as in rays.hpp.
  CostMap(const Metadata& meta, std::vector<uint8_t> widened);
  CostMap(Metadata&& meta, std::vector<uint8_t> widened) = delete;
  void add(const Facet& facet, uint32_t layer);  // as the grid sees it
  TreeRange stretch(const Shard& shard) const;
  // All of the tree in pieces that processes make one after another: as many as the cost asks for, so they do not depend on who makes them.
  // In a large grid a piece has whole index pages of level 0.
  struct Piece {
    TreeRange range;
    uint64_t cost;  // nanoseconds of casting, estimated
  };
  std::vector<Piece> pieces() const;

  // What is counted of a node: groups; facets in tiles, once for each that they may meet; crossings, and those of the body that has most of them.
  struct Load {
    uint64_t groups = 0, facets = 0, crossings = 0, of_one = 0;
    uint32_t body = 0;  // the latest; facets come body by body
    uint64_t of_latest = 0;
    uint64_t of_others() const { return crossings - of_one; }
  };
  // Of the nodes, u fastest; their side in rays. For who fits the cost to measured times.
  const std::vector<Load>& loads() const { return loads_; }
  uint64_t side() const { return rays_.size(height_); }

 private:
  using Cost = unsigned __int128;
  struct Stretch {
    uint64_t first, unit, units;  // keys from the first on: `units` times `unit` groups
    Cost of_unit;                 // taken to be even
  };
  Cost of_node(const Load& load) const;
  struct Node {
    uint64_t key;
    Cost cost;
  };
  std::vector<Node> nodes() const;
  Cost sum() const;
  std::vector<Stretch> stretches(uint64_t unit) const;
  struct Cut {
    uint64_t key;
    Cost before;  // what the part that ends here costs
  };
  static std::vector<Cut> cuts(std::span<const Stretch> stretches, Cost bound, Cost of_first);
  GridRays rays_;
  int height_ = 0;                       // of the nodes above the chunks of level 2
  uint32_t nodes_u_ = 0, nodes_v_ = 0;
  std::vector<Load> loads_;              // by node
  uint64_t facets_ = 0;
};

}  // namespace teracell::mesher
