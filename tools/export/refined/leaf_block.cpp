#include "tools/export/refined/leaf_block.hpp"

namespace teracell::exports {

size_t LeafBlock::memory() const {
  return sizeof *this + eights.capacity() * sizeof eights[0] + leaves.capacity() * sizeof leaves[0] + region.capacity() * 4;
}

Index3 LeafBlock::first_cell(uint32_t i) const {
  const Index3 inside = cell_of_code(leaves[i].code);
  return {(at[0] << kBits) + inside[0], (at[1] << kBits) + inside[1], (at[2] << kBits) + inside[2]};
}

}  // namespace teracell::exports
