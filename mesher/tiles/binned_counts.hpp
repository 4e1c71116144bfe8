// Counts the facets and shells of surfaces that don't fit into memory: within each bin, then across the facets that bins share.
#pragma once
#include <map>
#include <mutex>

#include "mesher/closing/surface_counts.hpp"
#include "mesher/tiles/bins.hpp"
#include "store/base/groups.hpp"

namespace teracell::mesher {

// Memory: proportional to the number of facets that lie in several bins, and of shells. Threads may share it, each with its own
// Bin objects.
class BinnedCounter {
 public:
  // Counts the bodies of which wanted[body] is true.
  explicit BinnedCounter(std::vector<bool> wanted) : wanted_(std::move(wanted)), bodies_(wanted_.size()) {}

  // One bin, of about `facets` facets. Not thread-safe.
  class Bin {
   public:
    Bin(BinnedCounter& all, uint64_t facets);
    void add(const BinnedFacet& facet);
    void finish();  // after the last facet

   private:
    BinnedCounter& all_;
    std::map<uint32_t, SurfaceCounter> counters_;    // by body
    std::vector<std::pair<uint32_t, Vec3>> shared_;  // body and first vertex of each facet that lies in other bins too
  };
  std::vector<SurfaceCounts> totals() const;

 private:
  // The shells within a bin that reach beyond it are nodes of a graph. A facet that lies in several bins joins the nodes of its
  // shell in these bins.
  struct Body {
    SurfaceCounts totals;  // of shells only those within one bin
    VertexNumbers nodes;   // of shared facets, by the first vertex
    Groups shells;         // of nodes
  };
  const std::vector<bool> wanted_;
  std::mutex mutex_;
  std::vector<Body> bodies_;
};

}  // namespace teracell::mesher
