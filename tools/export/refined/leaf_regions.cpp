#include "tools/export/refined/leaf_regions.hpp"

#include "store/base/groups.hpp"

namespace teracell::exports {

void find_regions(LeafBlock& block, const Box& box) {
  Groups groups(block.size());
  for (uint32_t i = 0; i < block.size(); ++i) {
    if (block.leaves[i].number == LeafBlock::kNotInMesh) continue;
    const Index3 first = block.first_cell(i);
    for (size_t axis = 0; axis < 3; ++axis)
      for (const int64_t step : {int64_t{-1}, int64_t{1} << block.leaves[i].level}) {
        Index3 next;
        for (size_t d = 0; d < 3; ++d) next[d] = std::max(first[d], box.lo[d]);
        next[axis] = first[axis] + step;
        if (next[axis] < box.lo[axis] || next[axis] >= box.hi[axis] || next[axis] >> LeafBlock::kBits != block.at[axis]) continue;
        // Of several finer ones this is the first; each of the others finds this one.
        const uint32_t other = block.find(next);
        if (block.leaves[other].number != LeafBlock::kNotInMesh) groups.join(i, other);
      }
  }
  block.region.assign(block.size(), 0);
  std::vector<uint32_t> number(block.size());
  uint32_t regions = 0;
  for (uint32_t i = 0; i < block.size(); ++i) {
    if (block.leaves[i].number == LeafBlock::kNotInMesh) continue;
    const uint32_t root = groups.of(i);
    if (root == i) number[i] = regions++;
    block.region[i] = number[root];
  }
}

}  // namespace teracell::exports
