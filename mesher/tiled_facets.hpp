// Facets -> tiling, from memory or by way of bins on disk.
#pragma once
#include <optional>

#include "mesher/tiles/binned_counts.hpp"
#include "mesher/bodies.hpp"
#include "mesher/tiles/tiling.hpp"

namespace teracell {

class Feed {
 public:
  // Keeps references to scene, bodies and meta; `tick` is called with shares of 1 while facets are spilled. Facets in memory
  // are moved to where the grid sees them. `wide` bodies as in rays.hpp.
  Feed(const Scene& scene, Bodies& bodies, const Metadata& meta, const std::vector<bool>& wide, const Budget& budget, int threads,
       const std::function<void(double)>& tick);

  Tiling& tiling() { return *tiling_; }
  uint64_t spilled_bytes() const { return spilled_; }
  // Of each body; waits. REQUIRES: every unit was taken from the tiling.
  std::vector<SurveyTotals> surveys();

 private:
  void use_memory(const std::vector<bool>& wide);
  std::unique_ptr<FacetBins> fill_bins(const std::vector<bool>& wide, const Budget& budget, int threads, const std::function<void(double)>& tick);

  const Scene& scene_;
  Bodies& bodies_;
  const Metadata& meta_;
  uint64_t spilled_ = 0;
  BinnedSurvey binned_;
  std::optional<Tiling> tiling_;  // last: it feeds the survey
};

}  // namespace teracell
