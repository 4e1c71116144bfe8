// From the bodies' facets to a tiling of facets as the grid sees them: in memory, or by way of bins on disk.
#pragma once
#include <memory>
#include <optional>

#include "mesher/bodies.hpp"
#include "mesher/tiles/binned_counts.hpp"
#include "mesher/tiles/tiling.hpp"

namespace teracell {

class TiledFacets {
 public:
  // Takes the facets out of `bodies`. Keeps references to scene, bodies and meta; `progress` is called with shares of 1 while facets
  // are spilled. `widened` bodies as in rays.hpp. Without `count`, counts() is not to be called.
  TiledFacets(const Scene& scene, Bodies& bodies, const Metadata& meta, const std::vector<bool>& widened, const TreeRange& range, bool count,
              const Budget& budget, int threads, const std::function<void(double)>& progress);

  Tiling& tiling() { return *tiling_; }
  const GridFacets* in_memory() const { return facets_.get(); }  // null when they were spilled
  uint64_t spilled_bytes() const { return spilled_; }
  // One per body; waits. REQUIRES: every group was taken from the tiling.
  std::vector<SurfaceCounts> counts();

 private:
  void use_memory(const std::vector<bool>& widened, const TreeRange& range, bool count);
  std::unique_ptr<FacetBins> fill_bins(const std::vector<bool>& widened, const TreeRange& range, const Budget& budget, int threads,
                                       const std::function<void(double)>& progress);

  const Scene& scene_;
  Bodies& bodies_;
  const Metadata& meta_;
  std::shared_ptr<GridFacets> facets_;
  uint64_t spilled_ = 0;
  BinnedCounter binned_;
  std::optional<Tiling> tiling_;  // last: it uses the others
};

}  // namespace teracell
