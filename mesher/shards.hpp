// Cuts a grid into parts that take about the same time: stretches of the tree of rays (pyramid.hpp). What a part holds depends on the
// scene, the axis of the rays, and the number of parts alone, so that parts can be made anywhere, and again.
#pragma once
#include <functional>
#include <string>

#include "mesher/surface/facet.hpp"
#include "mesher/tiles/rays.hpp"

namespace teracell {

struct Shard {
  uint32_t number = 0, of = 1;  // [0, of)
  std::string name() const;     // "shard-3-of-8"
};

// Estimates what casting costs, by nodes of the tree. In whole numbers, so that the sums do not depend on any order.
class CostMap {
 public:
  // Keeps references to the axes of `meta`; `widened` bodies as in rays.hpp.
  CostMap(const Metadata& meta, std::vector<bool> widened);
  CostMap(Metadata&& meta, std::vector<bool> widened) = delete;
  void add(const Facet& facet, uint32_t layer);  // as the grid sees it
  TreeRange stretch(const Shard& shard) const;

 private:
  GridRays rays_;
  int height_ = 0;                       // of the nodes above the chunks of level 2
  uint32_t nodes_u_ = 0, nodes_v_ = 0;
  std::vector<uint64_t> cost_;
};

}  // namespace teracell
