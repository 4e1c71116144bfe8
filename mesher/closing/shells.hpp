// Which facets of a surface hang together (its shells: facets connected by equal vertices), and which lie on each other.
//
// Needed only for surfaces that are open or hold opposite facets; it decides cells, so it is exact for surfaces that don't
// fit into memory too. Facets come in the file's order and are joined batch by batch, each batch a union-find over its
// vertices; what a batch calls a group is joined with the groups of other batches that have the same vertex, which
// meet in buckets by the vertex's hash. (Rejected: one table over all vertices. It takes 20 bytes per facet.)
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "mesher/surface/buckets.hpp"
#include "mesher/closing/surface_counts.hpp"

namespace teracell {

// Memory: a third of the budget, 24 bytes for every group of a batch (few, but for loose facets), and one bit per facet.
// Not thread-safe.
class Shells {
 public:
  // Of a surface of `facets` facets. With `bounded` the budget holds; else there is one batch and nothing is spilled.
  Shells(uint64_t facets, const Budget& budget, bool bounded);

  // All facets, in the file's order; then finish().
  void add(const Facet& facet);
  void finish();

  // After finish(). Shells are numbered in the order of their first facets.
  uint32_t count() const { return static_cast<uint32_t>(facets_.size()); }
  std::vector<uint32_t> of(const std::vector<Vec3>& vertices) const;  // REQUIRES: each is a vertex of some facet
  uint32_t of_facet(uint64_t facet) const;                            // fast in ascending order
  uint64_t facets(uint32_t shell) const { return facets_[shell]; }  // with three different vertices
  // Whether a facet has the vertices of one that comes before it in the file.
  bool repeats(uint64_t facet) const { return !repeats_.empty() && repeats_[facet]; }
  // How many facets of a shell cancel: of facets with the same vertices, those that are gone when opposite ones are taken
  // away in pairs. And whether that is half of the shell or more.
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

  uint32_t batch_root(uint32_t vertex);
  uint32_t group_root(uint32_t group);
  void end_batch();
  void join_groups();
  void find_repeated();
  void number_shells();

  const uint64_t most_;  // facets of a batch
  const uint64_t memory_;
  VertexNumbers numbers_;  // of the batch: these three; when there is but one batch they stay
  std::vector<uint32_t> parent_;
  std::vector<BatchFacet> batch_;
  uint64_t facets_before_ = 0;  // in earlier batches
  std::vector<uint32_t> group_parent_, group_shell_, first_group_of_vertex_;
  std::vector<uint64_t> facets_, cancelled_;  // by group while adding, by shell after finish()
  std::vector<bool> repeats_;
  std::vector<uint32_t> group_of_facet_;  // of all facets, or of those that wait to be written
  std::unique_ptr<SpillFile> file_;       // group_of_facet_ when bounded
  mutable std::vector<uint32_t> block_;
  mutable uint64_t block_first_ = 0;
  std::optional<Buckets<VertexRecord>> vertices_;
  std::optional<Buckets<FacetRecord>> by_vertices_;
};

}  // namespace teracell
