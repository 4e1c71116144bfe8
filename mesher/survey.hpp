// What a surface is made of: shells, degenerate and duplicate facets. For the report; decides no cell.
#pragma once
#include <atomic>

#include "mesher/facet_store.hpp"

namespace teracell {

struct Survey {
  uint64_t degenerate = 0;  // facets without area, exactly
  uint64_t duplicates = 0;  // facets whose three vertices another facet before them has
  uint64_t shells = 0;      // groups of facets connected by equal vertices
};

// Of the facets [first, last). Vertices are told apart by a 64-bit hash of their coordinates. Memory: some 25 bytes a
// facet, while it runs. Ends early, with nothing of use, once `stop` is set.
Survey survey(const FacetStore& facets, uint64_t first, uint64_t last, const std::atomic<bool>& stop);

}  // namespace teracell
