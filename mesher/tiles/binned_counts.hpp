// Counts what surfaces are made of that are never in memory whole: bin by bin, then what the bins share.
#pragma once
#include <map>
#include <mutex>
#include <unordered_map>

#include "mesher/tiles/bins.hpp"
#include "mesher/closing/surface_counts.hpp"

namespace teracell {

// Memory: by the facets that lie in several bins, and by the shells. Threads may share it, each with bins of its own.
class BinnedCounter {
 public:
  explicit BinnedCounter(size_t bodies) : bodies_(bodies) {}

  // One bin, of about `facets` facets. Not thread-safe.
  class Bin {
   public:
    Bin(BinnedCounter& all, uint64_t facets);
    void add(const BinnedFacet& facet);
    void finish();  // after the last one

   private:
    BinnedCounter& all_;
    std::map<uint32_t, SurfaceCounter> counters_;    // by body
    std::vector<std::pair<uint32_t, Vec3>> shared_;  // body and first vertex of the facets that lie in other bins too
  };
  std::vector<SurfaceCounts> totals() const;

 private:
  // Shells within a bin that reach beyond it are nodes; a facet that lies in several bins joins those of its shell in each.
  struct Body {
    SurfaceCounts totals;                           // shells: those within one bin
    std::unordered_map<uint64_t, uint32_t> nodes;  // of shared facets, by a hash of the first vertex
    std::vector<uint32_t> parent;                  // union-find over nodes
  };
  std::mutex mutex_;
  std::vector<Body> bodies_;
};

}  // namespace teracell
