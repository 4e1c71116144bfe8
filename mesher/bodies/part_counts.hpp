// Counts what a body of many copies is made of: each shape once.
#pragma once
#include <optional>
#include <string>

#include "mesher/surface/read_facets.hpp"

namespace teracell::mesher {

// Of the parts that a body takes by its glob. None where parts touch, since they may share vertices and facets, and where a matrix
// flattens a part: then facets must be counted where they stand.
std::optional<SurfaceCounts> part_counts(KeptTree& kept, const std::string& glob);

}  // namespace teracell::mesher
