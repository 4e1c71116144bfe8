#include "tools/export/refined/leaf_grid.hpp"

#include "store/base/groups.hpp"
#include "tools/export/refined/leaf_regions.hpp"

namespace teracell::exports {
namespace {

constexpr size_t kBlockMemory = size_t{96} << 20;
constexpr uint32_t kCodes = 1 << (3 * LeafBlock::kBits);

Index3 shifted_down(const Index3& cell, int bits) { return {cell[0] >> bits, cell[1] >> bits, cell[2] >> bits}; }

}  // namespace

LeafGrid::LeafGrid(const RefinedGrid& refined, const MeshOfLeaves& mesh) : refined_(refined), mesh_(mesh), blocks_(kBlockMemory) {}

std::shared_ptr<LeafBlock> LeafGrid::make(const Index3& at) const {
  auto out = std::make_shared<LeafBlock>();
  out->at = at;
  const Leaves& leaves = refined_.leaves();
  Subtree from{LeafBlock::kBits, at};
  out->cover = leaves.larger_leaf(from);
  if (out->cover) {
    if (shifted_down(out->cover->first(), LeafBlock::kBits) != at) return out;
    from = *out->cover;
    out->cover.reset();
  }
  const std::vector<LeafInSubtree> found = leaves.leaves_of(from, mesh_.box);
  int finest = LeafBlock::kBits;
  for (const LeafInSubtree& leaf : found) finest = std::min<int>(finest, leaf.level);
  out->shift = static_cast<uint32_t>(3 * finest);
  out->eights.resize(std::max<size_t>(1, kCodes >> out->shift >> 3));
  const std::vector<LabelInfo>& labels = leaves.reader().meta().labels;
  out->leaves.reserve(found.size());
  for (const LeafInSubtree& leaf : found) {
    const uint32_t code = leaf.code >> out->shift, material = labels[leaf.label].material;
    LeafBlock::Eight& eight = out->eights[code / 8];
    eight.starts |= static_cast<uint8_t>(1 << code % 8), ++eight.before;
    out->leaves.push_back({mesh_.in_mesh[material] ? out->in_mesh++ : LeafBlock::kNotInMesh, leaf.code, leaf.level, leaf.label, material});
  }
  uint32_t before = 0;
  for (LeafBlock::Eight& eight : out->eights) before += std::exchange(eight.before, before);
  if (regions_ != Regions::kIgnored) find_regions(*out, mesh_.box);
  if (regions_ == Regions::kFound) {
    const auto first = first_region_.find(at);
    out->in_mesh = 0;
    for (uint32_t i = 0; i < out->size(); ++i)
      if (uint32_t& number = out->leaves[i].number; number != LeafBlock::kNotInMesh)
        number = kept_[first->second + out->region[i]] ? out->in_mesh++ : LeafBlock::kNotInMesh;
  }
  if (const auto it = first_.find(at); it != first_.end()) out->first = it->second;
  return out;
}

std::shared_ptr<const LeafBlock> LeafGrid::block(const Index3& at) const {
  return blocks_.get(at, [&] {
    auto made = make(at);
    const size_t bytes = made->memory();
    return std::pair(std::shared_ptr<const LeafBlock>(std::move(made)), bytes);
  });
}

void LeafGrid::keep_largest_region(const std::function<void(double share)>& progress) {
  regions_ = Regions::kSought;
  Groups groups;
  std::vector<int64_t> cells;  // by region of a block
  using Counts = std::vector<int64_t>;
  for_each_block([&](double share) { progress(share / 2); },
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
                   first_region_[found.first] = groups.size();
                   for (const int64_t count : found.second) groups.add(), cells.push_back(count);
                 });
  using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;
  for_each_block([&](double share) { progress((1 + share) / 2); },
                 [&](const Index3& at) {
                   NearLeaves near(*this, at);
                   const LeafBlock& own = near.own();
                   Pairs pairs;
                   const auto region = [&](const LeafAt& leaf) { return first_region_.at(leaf.block->at) + leaf.block->region[leaf.i]; };
                   for (uint32_t i = 0; i < own.size(); ++i) {
                     const LeafAt leaf = near.leaf(own, i);
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
                   for (const auto& [a, b] : pairs) groups.join(a, b);
                 });
  Counts whole(cells.size());
  for (uint32_t i = 0; i < groups.size(); ++i) whole[groups.of(i)] += cells[i];
  const auto largest = static_cast<uint32_t>(std::ranges::max_element(whole) - whole.begin());
  for (uint32_t i = 0; i < groups.size(); ++i) kept_.push_back(groups.of(i) == largest);
  regions_ = Regions::kFound;
  blocks_.clear();
}

void LeafGrid::number(const std::function<void(double share)>& progress) {
  std::unordered_map<Index3, int64_t, PlaceHash> first;
  for_each_block(
      progress, [&](const Index3& at) { return make(at); },
      [&](const std::shared_ptr<LeafBlock>& block) {
        block->first = cells_;
        if (block->in_mesh > 0) first[block->at] = cells_;
        cells_ += block->in_mesh;
        blocks_.add(block->at, block, block->memory());
      });
  first_ = std::move(first);
}

LeafAt NearLeaves::elsewhere(const Index3& cell) {
  for (size_t d = 0; d < 3; ++d)
    if (cell[d] < box_.lo[d] || cell[d] >= box_.hi[d]) return {};
  const LeafBlock& found = block(shifted_down(cell, LeafBlock::kBits));
  return found.cover ? leaf(block(shifted_down(found.cover->first(), LeafBlock::kBits)), 0) : in(found, cell);
}

const LeafBlock& NearLeaves::block(const Index3& at) {
  const int64_t u = at[0] - centre_[0] + 1, v = at[1] - centre_[1] + 1, w = at[2] - centre_[2] + 1;
  if (u >= 0 && u <= 2 && v >= 0 && v <= 2 && w >= 0 && w <= 2) {
    auto& near = near_[static_cast<size_t>((w * 3 + v) * 3 + u)];
    if (!near) near = grid_.block(at);
    return *near;
  }
  for (const auto& known : far_)
    if (known->at == at) return *known;
  return *far_.emplace_back(grid_.block(at));
}

}  // namespace teracell::exports
