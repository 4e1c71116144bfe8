// Finds the shells of a surface (facets connected by equal vertices), and the facets that lie on each other.
//
// It is needed only for surfaces that are open or hold opposite facets. It decides cells, so it is exact, also for surfaces that
// don't fit into memory. Facets come in the file's order, in batches. Within a batch a union-find over vertices makes groups of
// facets. Groups of different batches that have a vertex in common are then joined: their records meet in a bucket by the
// vertex's hash. (Rejected: one table of all vertices, which takes 20 bytes per facet.)
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "mesher/closing/buckets.hpp"
#include "mesher/closing/surface_counts.hpp"
#include "store/base/groups.hpp"

namespace teracell::mesher {

// Memory: a third of the budget, 24 bytes per group (there are few unless facets are loose), and one bit per facet.
// Not thread-safe.
class Shells {
 public:
  // For a surface of `facets` facets. With `bounded` the memory is limited as above; else there is one batch and nothing is spilled.
  Shells(uint64_t facets, const Budget& budget, bool bounded);

  // Add all facets in the file's order, then call finish().
  void add(const Facet& facet);
  void finish();

  // After finish(). Shells are numbered in the order of their first facets.
  uint32_t count() const { return static_cast<uint32_t>(facets_.size()); }
  std::vector<uint32_t> of(const std::vector<Vec3>& vertices) const;  // REQUIRES: each is a vertex of some facet
  uint32_t of_facet(uint64_t facet) const;                            // fast in ascending order
  uint64_t facets(uint32_t shell) const { return facets_[shell]; }  // those with three different vertices
  // Whether an earlier facet of the file has the same three vertices.
  bool repeats(uint64_t facet) const { return !repeats_.empty() && repeats_[facet]; }
  // How many facets of a shell cancel: those that vanish when facets with the same vertices and opposite orientation are
  // removed in pairs. is_double(): whether these are half of the shell or more.
  uint64_t cancelled(uint32_t shell) const { return cancelled_[shell]; }
  bool is_double(uint32_t shell) const { return cancelled_[shell] > 0 && 2 * cancelled_[shell] >= facets_[shell]; }

 private:
  struct VertexRecord {
    VertexHash vertex;
    uint32_t group;
  };
  struct FacetRecord {
    VertexHash key;
    uint64_t facet;
    uint32_t group;
    bool odd;
  };
  struct BatchFacet {
    VertexHash key;
    uint32_t vertex;
    bool odd, three_different;
  };
  static constexpr size_t kBlock = size_t{1} << 16;  // group numbers read at once

  void end_batch();
  void join_groups();
  void find_repeated();
  void number_shells();

  const uint64_t most_;  // facets of a batch
  const uint64_t memory_;
  VertexNumbers numbers_;  // this and the next three are of the batch; if there is only one batch they stay
  RecentVertices recent_;
  Groups vertex_groups_;
  std::vector<BatchFacet> batch_;
  uint64_t facets_before_ = 0;  // in earlier batches
  Groups groups_;  // that are of one shell
  std::vector<uint32_t> group_shell_, first_group_of_vertex_;
  std::vector<uint64_t> facets_, cancelled_;  // by group while adding, by shell after finish()
  std::vector<bool> repeats_;
  std::vector<uint32_t> group_of_facet_;  // of all facets, or of those not written yet
  std::unique_ptr<SpillFile> file_;       // group_of_facet_ when bounded
  mutable std::vector<uint32_t> block_;
  mutable uint64_t block_first_ = 0;
  std::optional<Buckets<VertexRecord>> vertices_;
  std::optional<Buckets<FacetRecord>> by_vertices_;
};

}  // namespace teracell::mesher
