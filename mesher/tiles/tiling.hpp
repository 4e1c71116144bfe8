// Facets -> tiles of rays. The rays are a tree: a node of level 2k has 4 x 4 children, down to the chunks of level 0,
// and is itself the place of one chunk of level 2k of the pyramid. Walking the tree depth first hands every tile its
// facets, and completes the chunks of all levels one after another, with memory for one path only: facet numbers that
// are passed down, never a table of tiles. (Rejected: a list of facets for every tile. Twelve facets of a box over
// 10^5 x 10^5 rays would need gigabytes.)
//
// Facets that don't fit into memory lie in bins on disk, each a node of the tree (bins.hpp): it is loaded when the
// walk gets there.
#pragma once
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "mesher/tiles/binned_counts.hpp"
#include "mesher/tiles/bins.hpp"
#include "mesher/tiles/facet_store.hpp"
#include "mesher/surface/populate.hpp"
#include "mesher/tiles/rays.hpp"

namespace teracell {

// Facets in memory, and where each may have rays.
struct FacetBlock {
  std::shared_ptr<const GridFacets> facets;
  std::vector<ChunkRange, Populated<ChunkRange>> chunks;
};

// A facet in the list of a node. At depth 0 with the chunks [u0, u1) x [v0, v1) of the node's 4 x 4 that it may have rays
// in: to look these up in the block, row by row and in the order of the list, was most of splitting a group.
struct ListedFacet {
  uint32_t number;
  uint8_t u0, u1, v0, v1;
};

// 4 x 4 tiles (fewer at the grid's edge), each a chunk of level 0, and together one chunk of level 2.
struct TileGroup {
  uint32_t cu, cv;  // its place, in groups
  std::shared_ptr<const FacetBlock> block;
  std::vector<ListedFacet> facets;  // those that may meet its rays
};

// next() is not thread-safe; split() may run on any thread, also while next() runs.
class Tiling {
 public:
  // Of facets in memory; `wide` bodies as in rays.hpp.
  Tiling(std::shared_ptr<const GridFacets> facets, const Metadata& meta, std::vector<bool> wide);
  // `counter` counts the facets of every bin as it is loaded. The next `ahead` bins are loaded by threads of their own while
  // the groups of one are taken.
  Tiling(std::unique_ptr<FacetBins> bins, BinnedCounter& counter, int ahead, const Metadata& meta);

  uint64_t groups() const { return groups_; }
  // The groups in the order of the tree; those of rays without facets included.
  std::optional<TileGroup> next();
  // The facets of the group that may meet each chunk of a row of its 4 x 4; the lowest along the rays come first, roughly.
  std::array<std::vector<const SceneFacet*>, 4> split(const TileGroup& group, uint32_t row) const;

 private:
  struct Node {
    TreePlace place;
    std::shared_ptr<const FacetBlock> block;  // null: in bins
    std::vector<ListedFacet> facets;
  };
  class NodeBuilder;
  explicit Tiling(const Metadata& meta, std::vector<bool> wide = {});
  Node load(const TreePlace& place) const;
  Node take_bin(const TreePlace& place);
  void push_children(Node node);

  RayFrame rays_;
  uint32_t groups_u_, groups_v_;
  uint64_t groups_;
  std::unique_ptr<FacetBins> bins_;
  BinnedCounter* counter_ = nullptr;  // of the bins
  size_t ahead_ = 0;
  std::vector<Node> path_;
  std::deque<std::future<Node>> next_bins_;  // the first ones on the path; last: their threads use the others
};

}  // namespace teracell
