// The facets of a scene in memory, by number, in pieces that never move: a reading thread appends while another one
// studies what is there. (A vector that doubles copies everything again and holds three times as much meanwhile.)
// There are two types of them, so that coordinates of a file are never taken for those of the grid.
#pragma once
#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "mesher/engines/engine.hpp"

namespace teracell {

class FacetStore {
 public:
  FacetStore() = default;
  FacetStore(FacetStore&&) = default;
  FacetStore& operator=(FacetStore&&) = default;

  uint64_t size() const { return size_; }
  const SceneFacet& operator[](uint64_t i) const { return pieces_[i / kPiece][i % kPiece]; }
  // Appends as many of `facets` as its last piece takes, at least one, and returns where they are now. They stay there
  // while the store lives; one thread may append while others use what they were given.
  std::span<SceneFacet> append(std::span<const Facet> facets, uint32_t layer);
  void append_all(std::span<const Facet> facets, uint32_t layer) {
    while (!facets.empty()) facets = facets.subspan(append(facets, layer).size());
  }
  // Calls f(facet) for the facets [first, last) in order.
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
  // Small enough to waste nothing on small scenes. (Huge pages save the page faults, a tenth of reading, but where the
  // system must first find such a page they cost several times that.)
  static constexpr uint64_t kPiece = 4096;
  std::vector<std::unique_ptr<SceneFacet[]>> pieces_;
  uint64_t size_ = 0;
};

// In the coordinates of their files.
class FileFacets : public FacetStore {};

// As the grid sees them.
class GridFacets : public FacetStore {
 public:
  GridFacets() = default;
  // All of them are where the grid sees them already.
  explicit GridFacets(FileFacets&& facets) : FacetStore(std::move(facets)) {}
  // Calls move(facet) for each, to take it to where the grid sees it.
  template <class F>
  GridFacets(FileFacets&& facets, F&& move) : FacetStore(std::move(facets)) {
    for_each(0, size(), move);
  }
};

}  // namespace teracell
