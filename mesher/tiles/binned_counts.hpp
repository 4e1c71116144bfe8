// Counts the facets and shells of surfaces that don't fit into memory: within each bin, then across the facets that bins share.
#pragma once
#include <map>
#include <mutex>
#include <unordered_map>

#include "mesher/closing/surface_counts.hpp"
#include "mesher/tiles/bins.hpp"
#include "store/base/groups.hpp"

namespace teracell::mesher {

// Memory: proportional to the number of facets that lie in several bins of which some are done and some are not, and of shells; 4 bytes
// more for each facet that lies in several bins. Threads may share it, each with its own Bin objects.
class BinnedCounter {
 public:
  // Counts the bodies of which wanted[body] is true.
  explicit BinnedCounter(std::vector<bool> wanted) : wanted_(std::move(wanted)), bodies_(wanted_.size()) {}

  // One bin, of about `facets` facets. Not thread-safe.
  class Bin {
   public:
    Bin(BinnedCounter& all, uint64_t facets);
    Bin(const Bin&) = delete;
    void add(const BinnedFacets& facets);
    void finish();  // after the last facet

   private:
    BinnedCounter& all_;
    std::map<uint32_t, SurfaceCounter> counters_;  // by body
    SurfaceCounter* latest_ = nullptr;             // that of latest_body_, looked up once for many facets
    uint32_t latest_body_ = 0;
    struct Shared {
      uint32_t body;
      uint32_t number;    // of the facet's first vertex
      VertexHash vertex;  // the same
      uint64_t to_come;   // as in Node
    };
    std::vector<Shared> shared_;  // facets that lie in other bins too
    // A vertex of the block that facets come from, as latest_ knows it if it has the newest stamp.
    struct Known {
      VertexHash hash;
      uint32_t number = 0, stamp = 0;
    };
    static constexpr size_t kAtOnce = 64;
    void know(const BinnedFacets& facets);
    void share(const BinnedFacets::One& facet, const Known& first, uint64_t hash, uint32_t body);
    std::vector<Known> known_;
    uint32_t block_ = 0, stamp_ = 0;
    bool is_new_ = false;  // nothing of the block is known yet
  };
  std::vector<SurfaceCounts> totals() const;
  // How many vertices are kept because facets with them lie in bins that are still to come: for tests.
  size_t waiting() const;

 private:
  // The shells within a bin that reach beyond it are nodes of a graph. A facet that lies in several bins joins the nodes of its
  // shell in these bins. It is known by its first vertex until all of its bins are done; later no facet with that vertex comes, since all of
  // them lie in the vertex's bin.
  struct Node {
    uint32_t number;
    // Of the facets with that vertex: a hash of each one that was at home, as often as it has other bins, less a hash of each one that was in
    // another bin. It is 0 when all bins of all of them are done, and otherwise hardly ever (2^-63).
    uint64_t to_come = 0;
  };
  struct LowHalf {
    size_t operator()(const VertexHash& hash) const { return hash.low; }
  };
  struct Body {
    SurfaceCounts totals;  // of shells only those within one bin
    std::unordered_map<VertexHash, Node, LowHalf> nodes;
    Groups shells;  // of nodes
  };
  const std::vector<bool> wanted_;
  std::mutex mutex_;
  std::vector<Body> bodies_;
};

}  // namespace teracell::mesher
