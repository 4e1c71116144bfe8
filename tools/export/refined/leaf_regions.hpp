// Which cells of a mesh hang together through faces.
#pragma once
#include "tools/export/refined/leaf_block.hpp"

namespace teracell::exports {

// Fills LeafBlock::region: what hangs together within the block.
void find_regions(LeafBlock& block, const Box& box);

}  // namespace teracell::exports
