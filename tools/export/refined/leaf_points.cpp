#include "tools/export/refined/leaf_points.hpp"

#include <algorithm>
#include <bit>

namespace teracell::exports {
namespace {

constexpr size_t kPointMemory = size_t{64} << 20;
constexpr uint32_t kAllPlaces = (1U << 27) - 1;

// Whether a point is a corner of a face of the mesh: of a cell, or of a finer leaf beside one.
bool is_point(const NearLeaves::Around& around, const Index3& p) {
  for (size_t o = 0; o < 8; ++o) {
    const LeafAt& leaf = around[o];
    if (!leaf || !leaf.in_mesh()) continue;
    if (leaf.has_corner(p)) return true;
    for (size_t d = 0; d < 3; ++d)
      if (const LeafAt& beside = around[o ^ size_t{1} << d]; beside && beside.level < leaf.level && beside.has_corner(p)) return true;
  }
  return false;
}

// Which of a leaf's places at the middles of its lower edges and faces finer leaves may have a point at: a bit for each. Most have none.
uint32_t beside_finer(NearLeaves& near, const LeafAt& leaf) {
  if (leaf.level == 0) return 0;
  const auto finer = [&](const Index3& down) {
    const Index3 lo = leaf.lower();
    const LeafAt beside = near.at({lo[0] - down[0], lo[1] - down[1], lo[2] - down[2]});
    return beside && beside.level < leaf.level;
  };
  const bool x = finer({1, 0, 0}), y = finer({0, 1, 0}), z = finer({0, 0, 1});
  uint32_t out = 0;
  const auto set = [&](uint32_t number, bool is) { out |= static_cast<uint32_t>(is) << number; };
  set(1, y || z || finer({0, 1, 1})), set(3, x || z || finer({1, 0, 1})), set(9, x || y || finer({1, 1, 0}));
  set(1 + 3, z), set(1 + 9, y), set(3 + 9, x);
  return out;
}

}  // namespace

uint32_t part_of(const PartBegins& begins, int64_t cell) {
  if (begins.size() == 2) return 0;
  return static_cast<uint32_t>(std::ranges::upper_bound(begins, cell) - begins.begin() - 1);
}

const PointBlock::Entry* PointBlock::find(uint32_t leaf, uint32_t wanted) const {
  if (wanted == part) return &entries[leaf];
  const auto it = std::ranges::lower_bound(others, std::pair(leaf, wanted), {}, [](const Other& o) { return std::pair(o.leaf, o.part); });
  return it != others.end() && it->leaf == leaf && it->part == wanted ? &it->entry : nullptr;
}

int64_t PointBlock::first(uint32_t wanted) const {
  if (!parts.empty() && parts.front().first == wanted) return parts.front().second;
  return std::ranges::find(parts, wanted, &std::pair<uint32_t, int64_t>::first)->second;
}

LeafPoints::LeafPoints(const LeafGrid& grid, const PartBegins& begins)
    : grid_(grid), begins_(begins), points_(begins.size() - 1), blocks_(kPointMemory) {}

Index3 LeafPoints::place(const LeafAt& leaf, uint32_t number) {
  Index3 out{};
  for (size_t d = 0; d < 3; ++d, number /= 3)
    out[d] = number % 3 == 0 ? leaf.lo(d) : number % 3 == 1 ? leaf.first[d] + (int64_t{1} << leaf.level) / 2 : leaf.hi(d);
  return out;
}

PointBlock LeafPoints::make(const Index3& at) const {
  PointBlock out;
  NearLeaves near(grid_, at);
  const LeafBlock& block = near.own();
  const bool one_part = begins_.size() == 2;
  out.entries.resize(block.size());
  if (block.in_mesh > 0) out.part = part_of(begins_, block.first);
  for (uint32_t i = 0; i < block.size(); ++i) {
    const LeafAt leaf = near.leaf(block, i);
    const size_t others = out.others.size();
    const auto add = [&](uint32_t part, uint32_t number) {
      PointBlock::Entry* entry = part == out.part ? &out.entries[i] : nullptr;
      for (size_t o = others; entry == nullptr && o < out.others.size(); ++o)
        if (out.others[o].part == part) entry = &out.others[o].entry;
      if (entry == nullptr) entry = &out.others.emplace_back(PointBlock::Other{i, part, {}}).entry;
      entry->points |= uint32_t{1} << number;
    };
    std::array<bool, 9> has{};  // by axis: a place halfway, a place at the upper side
    for (size_t d = 0; d < 3; ++d) has[3 * d] = true, has[3 * d + 1] = leaf.half(d).has_value(), has[3 * d + 2] = leaf.hi(d) == grid_.box().hi[d];
    const bool at_upper_side = has[2] || has[5] || has[8];
    const uint32_t possible = at_upper_side ? kAllPlaces : 1U | beside_finer(near, leaf);
    for (uint32_t rest = possible; rest != 0; rest &= rest - 1) {
      const auto number = static_cast<uint32_t>(std::countr_zero(rest));
      const std::array<uint32_t, 3> where{number % 3, number / 3 % 3, number / 9};
      if (!has[where[0]] || !has[3 + where[1]] || !has[6 + where[2]] || number == 13) continue;  // 13 is its middle
      if (one_part && number == 0 && leaf.in_mesh()) {
        add(0, 0);
        continue;
      }
      const Index3 p = place(leaf, number);
      const NearLeaves::Around around = near.around(p);
      if (!is_point(around, p)) continue;
      for (const LeafAt& beside : around)
        if (beside && beside.in_mesh()) add(part_of(begins_, beside.number()), number);
    }
    std::sort(out.others.begin() + static_cast<std::ptrdiff_t>(others), out.others.end(),
              [](const auto& a, const auto& b) { return a.part < b.part; });
  }
  const auto count = [&](uint32_t part, PointBlock::Entry& entry) {
    if (entry.points == 0) return;
    auto it = std::ranges::find(out.parts, part, &std::pair<uint32_t, int64_t>::first);
    if (it == out.parts.end()) it = out.parts.insert(it, {part, 0});
    entry.first = static_cast<uint32_t>(it->second);
    it->second += std::popcount(entry.points);
  };
  for (PointBlock::Entry& entry : out.entries) count(out.part, entry);
  for (PointBlock::Other& other : out.others) count(other.part, other.entry);
  return out;
}

void LeafPoints::number(const std::function<void(double share)>& progress) {
  using Parts = std::vector<std::pair<uint32_t, int64_t>>;
  std::unordered_map<Index3, Parts, PlaceHash> first;
  grid_.for_each_block(
      progress, [&](const Index3& at) { return std::pair(at, std::make_shared<PointBlock>(make(at))); },
      [&](const std::pair<Index3, std::shared_ptr<PointBlock>>& found) {
        Parts& parts = found.second->parts;
        if (parts.empty()) return;
        for (auto& [part, number] : parts) points_[part] += std::exchange(number, points_[part]);
        first[found.first] = parts;
        blocks_.add(found.first, found.second, found.second->memory());
      });
  first_ = std::move(first);
}

std::shared_ptr<const PointBlock> LeafPoints::block(const Index3& at) const {
  return blocks_.get(at, [&] {
    auto made = std::make_shared<PointBlock>(make(at));
    if (const auto it = first_.find(at); it != first_.end()) made->parts = it->second;
    const size_t bytes = made->memory();
    return std::pair(std::shared_ptr<const PointBlock>(std::move(made)), bytes);
  });
}

int64_t NearPoints::number(const Index3& p, uint32_t part, const Box& box) {
  Index3 cell;
  for (size_t d = 0; d < 3; ++d) cell[d] = std::min(p[d], box.hi[d] - 1);
  const LeafAt leaf = leaves_.at(cell);
  uint32_t number = 0;
  for (size_t d = 3; d-- > 0;) {
    const bool lower = p[d] == leaf.lo(d), upper = p[d] == leaf.hi(d);
    if (!lower && !upper && p[d] != leaf.first[d] + (int64_t{1} << leaf.level) / 2) return -1;
    number = number * 3 + (lower ? 0 : upper ? 2 : 1);
  }
  if (leaf.block != last_) {
    last_ = leaf.block;
    auto& points = blocks_[last_];
    if (!points) points = points_.block(last_->at);
    of_last_ = points.get();
  }
  const PointBlock::Entry* const entry = of_last_->find(leaf.i, part);
  const uint32_t bit = uint32_t{1} << number;
  if (entry == nullptr || (entry->points & bit) == 0) return -1;
  const uint32_t before = entry->points & (bit - 1);  // mostly none
  return of_last_->first(part) + entry->first + (before == 0 ? 0 : std::popcount(before));
}

}  // namespace teracell::exports
