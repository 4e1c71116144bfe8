// What becomes of a tile's facets beside crossings at sample points: sheets own the cells that they pass through, thin parts are
// found and kept.
#pragma once
#include <optional>

#include "mesher/thin/sheets.hpp"
#include "mesher/thin/thin.hpp"

namespace teracell {

// The bodies whose facets matter to rays beside those that they meet (rays.hpp): of each body, or empty when there is none.
// `count_thin` as in ThinParts.
std::vector<bool> wide_bodies(const Scene& scene, bool count_thin);

// Not thread-safe.
class Marker {
 public:
  // Keeps references.
  Marker(const Scene& scene, const Metadata& meta, const Labels& labels, bool count_thin);
  // Those of the facets that engines are to cast. Valid until it is called again.
  std::span<const SceneFacet* const> solids(std::span<const SceneFacet* const> facets);
  // Adds marks to the crossings of the solids. `cells` are those of the tile; facets as solids() was given them last.
  void mark(const Tile& tile, const Box& cells, Crossings& crossings);

  Tallies take_tallies() { return std::exchange(tallies_, {}); }
  uint64_t exact_decisions() const { return (sheets_ ? sheets_->exact_decisions() : 0) + (thin_ ? thin_->exact_decisions() : 0); }

 private:
  const Scene& scene_;
  std::optional<Sheets> sheets_;    // if there are any
  std::optional<ThinParts> thin_;   // if they are wanted
  std::vector<const SceneFacet*> of_solids_, of_sheets_;
  std::span<const SceneFacet* const> solids_;
  Marks marks_;
  Tallies tallies_;
};

}  // namespace teracell
