#include "mesher/tiles/facet_store.hpp"

#include <mutex>
#include <type_traits>
#include <utility>

namespace teracell::mesher {
namespace {

// Regions that no store uses. Never destroyed, since stores may be destroyed after any other object.
struct SpareRegions {
  static constexpr size_t kMost = 4;
  SpareRegions() { regions.reserve(kMost); }
  std::mutex mutex;
  std::vector<std::unique_ptr<void, HugeMemory>> regions;
};
SpareRegions& spare_regions() {
  static SpareRegions& spare = *new SpareRegions;
  return spare;
}

}  // namespace

void* FacetStore::Region::allocate() {
  SpareRegions& spare = spare_regions();
  {
    std::lock_guard lock(spare.mutex);
    if (!spare.regions.empty()) {
      void* const region = spare.regions.back().release();
      spare.regions.pop_back();
      return region;
    }
  }
  return HugeMemory::allocate(kPiecesOfRegion * kPiece * sizeof(SceneFacet));
}

void FacetStore::Region::operator()(void* region) const {
  SpareRegions& spare = spare_regions();
  std::unique_ptr<void, HugeMemory> unused(region);
  std::lock_guard lock(spare.mutex);
  if (spare.regions.size() < SpareRegions::kMost) spare.regions.push_back(std::move(unused));
}

void FacetStore::add_piece() {
  static_assert(std::is_trivially_copyable_v<SceneFacet>);
  const uint64_t number = pieces_.size();
  if (number < kSmall) {
    small_.push_back(std::make_unique_for_overwrite<SceneFacet[]>(kPiece));
    pieces_.push_back(small_.back().get());
  } else if (const uint64_t of_region = (number - kSmall) % kPiecesOfRegion; of_region == 0) {
    std::unique_ptr<void, Region> region(Region::allocate());
    regions_.push_back(std::move(region));
    pieces_.push_back(static_cast<SceneFacet*>(regions_.back().get()));
  } else {
    pieces_.push_back(pieces_.back() + kPiece);
  }
  if (number > 0) system::populate(pieces_.back(), kPiece * sizeof(SceneFacet));  // not the first one, which small scenes don't fill
}

std::span<SceneFacet> FacetStore::append(std::span<const Facet> facets, uint32_t layer, uint32_t patch) {
  const uint64_t used = size_ % kPiece;
  if (used == 0) add_piece();
  SceneFacet* const first = pieces_.back() + used;
  const size_t count = std::min<size_t>(facets.size(), kPiece - used);
  for (size_t i = 0; i < count; ++i) first[i] = {facets[i], layer, patch};
  size_ += count;
  return {first, count};
}

}  // namespace teracell::mesher
