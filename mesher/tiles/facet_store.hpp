// The facets of a scene in memory, by number. They are stored in pieces that never move, so one thread may append facets
// while another one uses those that are there. (A vector would copy all of them whenever it grows, and needs three times the
// memory meanwhile.) There are two types, so that coordinates of a file are never mistaken for those of the grid.
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "mesher/engines/engine.hpp"
#include "store/base/populate.hpp"

namespace teracell::mesher {

class FacetStore {
 public:
  FacetStore() = default;
  FacetStore(FacetStore&&) = default;
  FacetStore& operator=(FacetStore&&) = default;

  uint64_t size() const { return size_; }
  const SceneFacet& operator[](uint64_t i) const { return pieces_[i / kPiece][i % kPiece]; }
  // Appends as many of `facets` as fit into the last piece, at least one, and returns their place. They stay there as long as
  // the store lives. One thread may append while others use facets that were returned.
  std::span<SceneFacet> append(std::span<const Facet> facets, uint32_t layer, uint32_t patch = 0);
  // The place of one more facet, to be filled at once. (A facet made elsewhere, vertex by vertex, was copied in larger words than those that it had
  // just been written in, and waited until those had reached the cache.)
  SceneFacet& append() {
    if (size_ % kPiece == 0) add_piece();
    constexpr uint64_t kSoon = 13;  // a kilobyte of facets, which are about to be filled, too
    const uint64_t at = size_++ % kPiece;
    SceneFacet* const piece = pieces_.back();
    __builtin_prefetch(piece + std::min(at + kSoon, kPiece - 1), 1);
    return piece[at];
  }
  void append_all(std::span<const Facet> facets, uint32_t layer, uint32_t patch) {
    while (!facets.empty()) facets = facets.subspan(append(facets, layer, patch).size());
  }
  // Calls f(facet) for facets first to last - 1 in order.
  template <class F>
  void for_each(uint64_t first, uint64_t last, F&& f) {
    for (uint64_t i = first; i < last;) {
      SceneFacet* facet = &pieces_[i / kPiece][i % kPiece];
      for (const uint64_t stop = std::min(last, (i / kPiece + 1) * kPiece); i < stop; ++i) f(*facet++);
    }
  }
  template <class F>
  void for_each(uint64_t first, uint64_t last, F&& f) const {
    const_cast<FacetStore&>(*this).for_each(first, last, [&](const SceneFacet& facet) { f(facet); });
  }

 private:
  // The first pieces are small, so that small scenes waste little memory. More come from regions of whole huge pages.
  static constexpr uint64_t kPiece = 4096, kSmall = 4, kPiecesOfRegion = 32;
  static_assert(kPiecesOfRegion * kPiece * sizeof(SceneFacet) % system::kHugePage == 0);
  // Keeps some regions for the next stores: bins of facets come and go by the hundred, and the kernel would clear all pages anew for each.
  struct Region {
    static void* allocate();
    void operator()(void* region) const;
  };
  void add_piece();
  std::vector<SceneFacet*> pieces_;
  std::vector<std::unique_ptr<SceneFacet[]>> small_;
  std::vector<std::unique_ptr<void, Region>> regions_;
  uint64_t size_ = 0;
};

// Facets in the coordinates of their files.
class FileFacets : public FacetStore {};

// Facets as the grid sees them.
class GridFacets : public FacetStore {
 public:
  GridFacets() = default;
  // REQUIRES: all facets are already where the grid sees them.
  explicit GridFacets(FileFacets&& facets) : FacetStore(std::move(facets)) {}
  // Calls move(facet) for each facet, which transforms it to where the grid sees it.
  template <class F>
  GridFacets(FileFacets&& facets, F&& move) : FacetStore(std::move(facets)) {
    for_each(0, size(), move);
  }
};

}  // namespace teracell::mesher
