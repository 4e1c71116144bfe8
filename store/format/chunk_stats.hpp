// The statistics that an index page has of a chunk of level 0, counted from its runs. Pure.
#pragma once
#include "store/format/format.hpp"
#include "store/runs/run.hpp"

namespace teracell::inline store {

// The cells and the box of every label of a block of level 0, labels ascending.
std::vector<LabelStats> stats_of(const RayBlock& rays);

}  // namespace teracell::store
