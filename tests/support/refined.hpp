// The leaves of refined grids from their definition, cell by cell: nothing of store/refine is used.
#pragma once
#include "store/refine/leaves.hpp"
#include "tests/support/stored.hpp"

namespace teracell::testing {

// Cells x fastest. `patches`: of the face between a cell and its upper neighbour along an axis.
using PatchOf = std::function<uint32_t(const Index3& cell, int axis)>;
std::vector<Leaf> leaves_by_definition(const Metadata& meta, const std::vector<Label>& cells, const Refinement& refinement, const Box& region,
                                       const PatchOf& patches = nullptr);

// Balls and plates of random labels: cells as surfaces make them.
std::vector<Label> blobs(std::mt19937_64& random, const Index3& n, uint32_t labels);

}  // namespace teracell::testing
