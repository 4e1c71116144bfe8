// Gives cells to bodies beyond the crossings at sample points: sheets own the cells that they pass through, and thin parts are
// found and kept.
#pragma once
#include <optional>

#include "mesher/thin/sheets.hpp"
#include "mesher/thin/thin.hpp"

namespace teracell {

// For each body, whether its facets matter to rays that they do not meet (rays.hpp); empty if this is so for no body.
// `all_solids`: those of every solid do, not only of those that keep their thin parts.
std::vector<bool> widened_bodies(const Scene& scene, bool all_solids);

// Not thread-safe.
class Marker {
 public:
  // Keeps references.
  Marker(const Scene& scene, const Metadata& meta, const Labels& labels, bool count_thin);
  // Returns the facets that engines should cast. The result is valid until the next call.
  std::span<const SceneFacet* const> solids(std::span<const SceneFacet* const> facets);
  // Adds marks to the crossings of the solids. `cells` are those of the tile. The facets are those of the last call of solids().
  void mark(const Tile& tile, const Box& cells, Crossings& crossings);

  Tallies take_tallies() { return std::exchange(tallies_, {}); }
  uint64_t exact_decisions() const { return (sheets_ ? sheets_->exact_decisions() : 0) + (thin_ ? thin_->exact_decisions() : 0); }

 private:
  const Scene& scene_;
  std::optional<Sheets> sheets_;    // if the scene has sheets
  std::optional<ThinParts> thin_;   // if any body needs it
  std::vector<const SceneFacet*> of_solids_, of_sheets_;
  std::span<const SceneFacet* const> solids_;
  Marks marks_;
  Tallies tallies_;
};

}  // namespace teracell
