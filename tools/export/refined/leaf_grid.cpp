#include "tools/export/refined/leaf_grid.hpp"

#include "tools/export/refined/leaf_regions.hpp"

namespace teracell::exports {
namespace {

constexpr size_t kBlockMemory = size_t{96} << 20;
constexpr uint32_t kCodes = 1 << (3 * LeafBlock::kBits);

Index3 shifted_down(const Index3& cell, int bits) { return {cell[0] >> bits, cell[1] >> bits, cell[2] >> bits}; }

}  // namespace

size_t LeafBlock::memory() const { return sizeof *this + eights.capacity() * sizeof eights[0] + leaves.capacity() * sizeof leaves[0] + region.capacity() * 4; }

Index3 LeafBlock::first_cell(uint32_t i) const {
  const Index3 inside = cell_of_code(leaves[i].code);
  return {(at[0] << kBits) + inside[0], (at[1] << kBits) + inside[1], (at[2] << kBits) + inside[2]};
}

LeafGrid::LeafGrid(const RefinedGrid& refined, const MeshOfLeaves& mesh) : refined_(refined), mesh_(mesh), blocks_(kBlockMemory) {}

std::shared_ptr<LeafBlock> LeafGrid::make(const Index3& at) const {
  auto out = std::make_shared<LeafBlock>();
  out->at = at;
  const Leaves& leaves = refined_.leaves();
  Subtree from{LeafBlock::kBits, at};
  if ((out->cover = leaves.larger_leaf(from))) {
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

void LeafGrid::number(const std::function<void(double share)>& progress, const std::function<void(const LeafBlock&)>& see) {
  std::unordered_map<Index3, int64_t, PlaceHash> first;
  for_each_block(
      progress, [&](const Index3& at) { return make(at); },
      [&](const std::shared_ptr<LeafBlock>& block) {
        block->first = cells_;
        if (block->in_mesh > 0) first[block->at] = cells_;
        cells_ += block->in_mesh;
        see(*block);
        blocks_.add(block->at, block, block->memory());
      });
  first_ = std::move(first);
}

const LeafBlock& NearLeaves::far(const Index3& at) {
  for (const auto& known : far_)
    if (known->at == at) return *known;
  return *far_.emplace_back(grid_.block(at));
}

}  // namespace teracell::exports
