// Which thin cells of a label touch, also at edges and corners (26 neighbours): regions, found block by block. They are few, so each run is looked
// up among those of the nine rays around it. What no later block can touch is finished, as components are (components.hpp).
#pragma once
#include <functional>
#include <span>

#include "store/base/groups.hpp"
#include "store/check/components.hpp"
#include "store/check/thickness.hpp"

namespace teracell::inline store {

// Cells of a ray of the grid, and the region that they belong to.
struct RegionRun {
  uint32_t u, v, from, to, region;
  Label label;
};

struct BlockRegions {
  std::vector<Component> all;
  std::vector<RegionRun> border;  // of the rays at the block's sides, by v, u and from
};

// `runs`: of a block, by v, u and from, with the places of their rays in the grid. `block`: its rays in the grid.
BlockRegions regions_of(std::span<const ThinRun> runs, const RayWindow& block, const RayFrame& frame);

// Joins the regions of blocks, which come in the order of their columns: u fastest.
class RegionJoiner {
 public:
  RegionJoiner(const LevelShape& shape, Finished finished) : open_(std::move(finished)), above_(shape.chunks_u) {}
  void add(uint32_t cu, BlockRegions&& block);
  void finish() { open_.finish_others(); }

 private:
  void join(std::span<const RegionRun> runs, std::span<const RegionRun> others);

  OpenComponents open_;
  std::vector<RegionRun> before_, corner_;     // of the block before, and of the one above that
  std::vector<std::vector<RegionRun>> above_;  // of the last row of blocks; the row that comes replaces them
};

}  // namespace teracell::store
