#include "mesher/tiles/facet_store.hpp"

#include "store/base/populate.hpp"

namespace teracell::mesher {

void FacetStore::add_piece() {
  pieces_.push_back(std::make_unique_for_overwrite<SceneFacet[]>(kPiece));
  if (size_ != 0) system::populate(pieces_.back().get(), kPiece * sizeof(SceneFacet));  // not the first one, which small scenes don't fill
}

std::span<SceneFacet> FacetStore::append(std::span<const Facet> facets, uint32_t layer, uint32_t patch) {
  const uint64_t used = size_ % kPiece;
  if (used == 0) add_piece();
  SceneFacet* const first = pieces_.back().get() + used;
  const size_t count = std::min<size_t>(facets.size(), kPiece - used);
  for (size_t i = 0; i < count; ++i) first[i] = {facets[i], layer, patch};
  size_ += count;
  return {first, count};
}

}  // namespace teracell::mesher
