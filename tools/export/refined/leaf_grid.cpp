#include "tools/export/refined/leaf_grid.hpp"

namespace teracell::exports {
namespace {

constexpr size_t kBlockMemory = size_t{96} << 20;
constexpr uint32_t kCodes = 1 << (3 * LeafBlock::kBits);

Index3 shifted_down(const Index3& cell, int bits) { return {cell[0] >> bits, cell[1] >> bits, cell[2] >> bits}; }

}  // namespace

size_t LeafBlock::memory() const {
  return sizeof *this + starts.capacity() + before.capacity() * 4 + code.capacity() * 4 + level.capacity() + material.capacity() * 2 + number.capacity() * 4 +
         label.capacity() * 4;
}

Index3 LeafBlock::first_cell(uint32_t i) const {
  const Index3 inside = cell_of_code(code[i]);
  return {(at[0] << kBits) + inside[0], (at[1] << kBits) + inside[1], (at[2] << kBits) + inside[2]};
}

LeafGrid::LeafGrid(const RefinedGrid& refined, const MeshOfLeaves& mesh) : refined_(refined), mesh_(mesh), blocks_(kBlockMemory) {}

std::shared_ptr<const LeafBlock> LeafGrid::make(const Index3& at) const {
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
  out->starts.resize(kCodes / 8), out->before.resize(kCodes / 8);
  const std::vector<LabelInfo>& labels = leaves.reader().meta().labels;
  for (const LeafInSubtree& leaf : found) {
    out->starts[leaf.code / 8] |= static_cast<uint8_t>(1 << leaf.code % 8);
    ++out->before[leaf.code / 8];
    out->code.push_back(leaf.code);
    out->level.push_back(static_cast<uint8_t>(leaf.level));
    out->label.push_back(leaf.label);
    const uint32_t material = labels[leaf.label].material;
    out->material.push_back(static_cast<uint16_t>(material));
    out->number.push_back(mesh_.in_mesh[material] ? out->in_mesh++ : LeafBlock::kNotInMesh);
  }
  uint32_t before = 0;
  for (uint32_t& leaves : out->before) before += std::exchange(leaves, before);
  if (const auto it = first_.find(at); it != first_.end()) out->first = it->second;
  return out;
}

std::shared_ptr<const LeafBlock> LeafGrid::block(const Index3& at) const {
  return blocks_.get(at, [&] {
    auto made = make(at);
    const size_t bytes = made->memory();
    return std::pair(std::move(made), bytes);
  });
}

void LeafGrid::number(const std::function<void(double share)>& progress, const std::function<void(const LeafBlock&)>& see) {
  std::unordered_map<Index3, int64_t, PlaceHash> first;
  for_each_block(
      progress, [&](const Index3& at) { return make(at); },
      [&](const std::shared_ptr<const LeafBlock>& block) {
        if (block->in_mesh > 0) first[block->at] = cells_;
        cells_ += block->in_mesh;
        see(*block);
      });
  first_ = std::move(first);
}

const LeafBlock& NearLeaves::far(const Index3& at) {
  for (const auto& known : far_)
    if (known->at == at) return *known;
  return *far_.emplace_back(grid_.block(at));
}

}  // namespace teracell::exports
