#include "tools/export/refined/leaf_regions.hpp"

namespace teracell::exports {

void find_regions(LeafBlock& block, const Box& box) {
  JoinedSets sets;
  for (uint32_t i = 0; i < block.size(); ++i) sets.add();
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
        if (block.leaves[other].number != LeafBlock::kNotInMesh) sets.join(i, other);
      }
  }
  block.region.assign(block.size(), 0);
  std::vector<uint32_t> number(block.size());
  uint32_t regions = 0;
  for (uint32_t i = 0; i < block.size(); ++i) {
    if (block.leaves[i].number == LeafBlock::kNotInMesh) continue;
    const uint32_t root = sets.root(i);
    if (root == i) number[i] = regions++;
    block.region[i] = number[root];
  }
}

void LeafGrid::keep_largest_region(const std::function<void(double share)>& progress) {
  regions_ = Regions::kSought;
  JoinedSets sets;
  std::vector<int64_t> cells;  // by region of a block
  using Counts = std::vector<int64_t>;
  for_each_block(
      [&](double share) { progress(share / 2); },
      [&](const Index3& at) {
        const auto found = block(at);
        Counts counts;
        for (uint32_t i = 0; i < found->size(); ++i) {
          if (found->leaves[i].number == LeafBlock::kNotInMesh) continue;
          if (found->region[i] >= counts.size()) counts.resize(found->region[i] + 1);
          ++counts[found->region[i]];
        }
        return std::pair(at, counts);
      },
      [&](const std::pair<Index3, Counts>& found) {
        if (found.second.empty()) return;
        first_region_[found.first] = sets.size();
        for (const int64_t count : found.second) sets.add(), cells.push_back(count);
      });
  using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;
  for_each_block(
      [&](double share) { progress((1 + share) / 2); },
      [&](const Index3& at) {
        const auto own = block(at);
        NearLeaves near(*this, at);
        Pairs pairs;
        const auto region = [&](const LeafAt& leaf) { return first_region_.at(leaf.block->at) + leaf.block->region[leaf.i]; };
        for (uint32_t i = 0; i < own->size(); ++i) {
          const LeafAt leaf = near.leaf(*own, i);
          if (!leaf.in_mesh()) continue;
          for (size_t axis = 0; axis < 3; ++axis)
            for (const bool up : {false, true}) {
              const LeafAt other = near.beside(leaf, axis, up);
              if (!other || !other.in_mesh() || other.block == leaf.block) continue;
              const std::pair both{region(leaf), region(other)};
              if (pairs.empty() || pairs.back() != both) pairs.push_back(both);
            }
        }
        return pairs;
      },
      [&](const Pairs& pairs) {
        for (const auto& [a, b] : pairs) sets.join(a, b);
      });
  Counts whole(cells.size());
  for (uint32_t i = 0; i < sets.size(); ++i) whole[sets.root(i)] += cells[i];
  const auto largest = static_cast<uint32_t>(std::ranges::max_element(whole) - whole.begin());
  for (uint32_t i = 0; i < sets.size(); ++i) kept_.push_back(sets.root(i) == largest);
  regions_ = Regions::kFound;
  blocks_.clear();
}

}  // namespace teracell::exports
