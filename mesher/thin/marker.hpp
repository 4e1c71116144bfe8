// Gives cells to bodies beyond the crossings at sample points: sheets own the cells that they pass through, and thin parts are
// found and kept.
#pragma once
#include <optional>

#include "mesher/thin/sheets.hpp"
#include "mesher/thin/thin.hpp"

namespace teracell::mesher {

// Whether some cells may belong to bodies that their sample points are not inside of.
bool has_marks(const Scene& scene);
// For each body, how many rays further its facets matter than those that they meet (rays.hpp); empty if it is 0 for all. `all_solids`: those
// of every solid do, not only of those that keep their thin parts. `links`: cells are compared with their neighbours.
std::vector<uint8_t> widened_bodies(const Scene& scene, bool all_solids, bool links);

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

}  // namespace teracell::mesher
