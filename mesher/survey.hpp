// What a surface is made of: shells, degenerate and duplicate facets. For the report; decides no cell.
#pragma once
#include <span>

#include "mesher/engine.hpp"

namespace teracell {

struct Survey {
  uint64_t degenerate = 0;  // facets without area, exactly
  uint64_t duplicates = 0;  // facets whose three vertices another facet before them has
  uint64_t shells = 0;      // groups of facets connected by equal vertices
};

// Vertices are told apart by a 64-bit hash of their coordinates. Memory: some 40 bytes a facet, while it runs.
Survey survey(std::span<const SceneFacet> facets);

}  // namespace teracell
