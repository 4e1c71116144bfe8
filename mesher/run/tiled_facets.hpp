// From the bodies' facets to a tiling of facets as the grid sees them: in memory, or by way of bins.
#pragma once
#include <memory>
#include <optional>

#include "mesher/bodies/patches.hpp"
#include "mesher/tiles/binned_counts.hpp"
#include "mesher/tiles/tiling.hpp"

namespace teracell::mesher {

class TiledFacets {
 public:
  // Keeps references to scene, bodies, meta, widened and budget; `progress` is called with shares of 1 while facets are spilled. `widened`
  // bodies as in rays.hpp. `patches`: facets get those, if it isn't null.
  TiledFacets(const Scene& scene, Bodies& bodies, const Metadata& meta, const std::vector<uint8_t>& widened, const Budget& budget, int threads,
              const Patches* patches, std::function<void(double)> progress);
  ~TiledFacets();

  // Tiles the facets of a stretch of the tree; the tiling before this one is gone. The first call takes facets in memory out of `bodies`;
  // `again`: there may be another one, so those that were added are kept. `count` is for counts(): one tiling may do that.
  Tiling& tile(const TreeRange& range, bool count, bool again);
  const GridFacets* in_memory() const { return facets_.get(); }  // null when they were spilled
  uint64_t spilled_bytes() const { return spilled_; }  // to disk
  uint64_t held_bytes() const { return held_; }        // in files in memory, which the system does not count as the process's
  // One per body; waits. REQUIRES: every group was taken from the tiling that counts.
  std::vector<SurfaceCounts> counts();

 private:
  uint32_t patch_of(size_t body, uint32_t patch) const { return patches_ ? patches_->of(static_cast<uint32_t>(body), patch) : 0; }
  void take_from_memory(bool count);
  std::unique_ptr<FacetBins> fill_bins(const TreeRange& range, bool again);
  void add_logged(size_t b, FacetBins& bins, Background& idle, const std::function<void(double)>& went_on);

  const Scene& scene_;
  Bodies& bodies_;
  const Metadata& meta_;
  const std::vector<uint8_t>& widened_;
  const Budget& budget_;
  const int threads_;
  const Patches* const patches_;
  const std::function<void(double)> progress_;
  std::shared_ptr<GridFacets> facets_;
  uint64_t spilled_ = 0, held_ = 0;
  BinnedCounter binned_;
  std::optional<Tiling> tiling_;  // last: it uses the others
};

}  // namespace teracell::mesher
