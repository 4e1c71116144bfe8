// Facets -> tiles of rays. The rays form a tree. A node of level 2k has 4 x 4 children, down to the chunks of level 0, and
// is the place of one chunk of level 2k of the pyramid. A depth-first walk gives every tile its facets and completes the
// chunks of all levels one after another. It needs memory for one path only: facet numbers are passed down, and there is no
// table of tiles. (Rejected: a list of facets for every tile. The twelve facets of a box over 10^5 x 10^5 rays would need
// gigabytes.)
//
// A tiling may be of a stretch of the tree only: then a grid is made in parts.
//
// Facets that are too many for that lie in bins. Each bin is a node of the tree (bins.hpp) and is loaded before the walk
// reaches it, by the threads that cast the rays: each of them either loads or casts, so there is hardly anything to wait for. (With threads of their
// own for loading, a core stood idle for a third of the time, while threads that were ready waited for the other one. With a taking thread that loads
// only where it has no rows to cast, 25.6 million facets took 1.1 times as long.)
#pragma once
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "mesher/tiles/binned_counts.hpp"
#include "mesher/tiles/bins.hpp"
#include "mesher/tiles/facet_store.hpp"
#include "mesher/tiles/rays.hpp"
#include "store/base/populate.hpp"

namespace teracell::mesher {

// Facets in memory, where each may have rays, and how high its lowest vertex lies along them, in 4096ths of the grid.
struct FacetBlock {
  std::shared_ptr<const GridFacets> facets;
  std::vector<ChunkRange, Populated<ChunkRange>> chunks;
  std::vector<uint16_t> heights;
};

// A facet of a group, and the chunks [u0, u1) x [v0, v1) of its 4 x 4 in which the facet may have rays. (Looking these up in the block for
// each row took most of the time of splitting a group.)
struct ListedFacet {
  uint32_t number;
  uint16_t height;
  uint16_t u0 : 4, u1 : 4, v0 : 4, v1 : 4;
};

// 4 x 4 tiles (fewer at the grid's edge). Each tile is a chunk of level 0, and all together are one chunk of level 2.
struct TileGroup {
  uint32_t cu, cv;  // its place, in groups
  std::shared_ptr<const FacetBlock> block;
  std::vector<ListedFacet> facets;  // those that may meet its rays, from the lowest to the highest along them
  bool passed = false;  // no group: the walk went on outside the range, and others may have their turn before it goes on
};

// next(), next_load() and pass() are not thread-safe; split() may run on any thread, also while they run.
class Tiling {
 public:
  // Of facets in memory; `widened` bodies as in rays.hpp.
  Tiling(std::shared_ptr<const GridFacets> facets, const Metadata& meta, std::vector<uint8_t> widened, const TreeRange& range = {});
  // `counter`, if not null, counts the facets of every bin; then bins outside the range are loaded, too. At most `ahead` bins with facets are loaded
  // before their groups are taken.
  Tiling(std::unique_ptr<FacetBins> bins, BinnedCounter* counter, int ahead, const Metadata& meta, const TreeRange& range = {});

  uint64_t groups() const { return groups_; }
  // The groups of the range in the order of the tree, including those without facets; or TileGroup::passed, when a bin was passed by. Loads a bin
  // that no next_load() has returned, and waits for one that another thread loads.
  std::optional<TileGroup> next();
  // What loads the next bin, for in_order() to do aside; null if enough of them are loaded or being loaded. It must be called once, on any thread,
  // since next() will wait for it.
  std::function<void()> next_load();
  // Takes so many groups, or all that are left, with several threads, and calls went_on(how many) on this one after each.
  void pass(uint64_t groups, int threads, const std::function<void(uint64_t taken)>& went_on);
  // Leaves out the groups with lower keys (pyramid.hpp). REQUIRES: the facets are in memory.
  void skip_to(uint64_t key) { range_.first = std::max(range_.first, key); }
  // For each tile in a row of the group's 4 x 4, the facets that may meet it, roughly from the lowest to the highest along the rays.
  std::array<std::vector<const SceneFacet*>, kFanOut> split(const TileGroup& group, uint32_t row) const;

 private:
  struct Node {
    TreePlace place;
    std::shared_ptr<const FacetBlock> block;  // null: the facets are in bins
    std::vector<uint32_t> facets;  // ascending, so that a node's children are made by one walk through the block
  };
  class NodeBuilder;
  Tiling(const Metadata& meta, std::vector<uint8_t> widened, const TreeRange& range);
  bool wanted(const TreePlace& place) const { return range_.has_any(place.depth, place.cu, place.cv); }
  uint64_t groups_below(const TreePlace& place) const;
  RayRange within_range(const RayRange& rays) const;
  // Whether a node's facets are loaded at once from its bin, or, if it is a group, from its bins one after another.
  bool is_loaded_whole(const TreePlace& place) const { return place.depth == 0 || !bins_->is_split(place); }
  Node load(const TreePlace& place) const;
  Node take_bin(const TreePlace& place);
  std::vector<Node> children_of(const Node& node) const;
  static std::vector<ListedFacet> listed(const Node& node);

  GridRays rays_;
  TreeRange range_;
  uint32_t groups_u_, groups_v_;  // of the whole grid
  uint64_t groups_;
  bool has_all_;  // the range is the whole grid
  std::unique_ptr<FacetBins> bins_;
  BinnedCounter* counter_ = nullptr;  // for bins
  size_t ahead_ = 0;
  std::vector<Node> path_;
  std::deque<std::future<Node>> next_bins_;  // the next ones on the path that next_load() has returned
};

}  // namespace teracell::mesher
