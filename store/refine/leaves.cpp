#include "store/refine/leaves.hpp"

#include <algorithm>

#include "store/base/in_order.hpp"

namespace teracell::inline store {
namespace {

constexpr int kBlockLevel = RefinedBlock::kBits;  // of a block of tier 0 as one cell

// Every third bit of a Morton code.
uint32_t every_third(uint32_t code) {
  code &= 0x09249249;
  code = (code | code >> 2) & 0x030c30c3;
  code = (code | code >> 4) & 0x0300f00f;
  code = (code | code >> 8) & 0x030000ff;
  return (code | code >> 16) & 0x000003ff;
}

}  // namespace

Index3 cell_of_code(uint32_t code) { return {every_third(code), every_third(code >> 1), every_third(code >> 2)}; }

Leaves::Walk::Walk(const Leaves& leaves, const Box& box, int level) : leaves_(leaves), box_(box), level_(level) {
  int root = std::max(level, leaves.coarsest());
  for (const int64_t cells : leaves.reader_.meta().grid.cells())
    while (int64_t{1} << root < cells) ++root;
  waiting_.push_back({root, {0, 0, 0}});
}

std::optional<Subtree> Leaves::Walk::next() {
  while (!waiting_.empty()) {
    const Subtree s = waiting_.back();
    waiting_.pop_back();
    if (!meets(s)) continue;
    if (s.level == level_ || (s.level <= leaves_.coarsest() && !leaves_.is_split(s.level, s.cell))) return s;
    for (int child = 7; child >= 0; --child)
      waiting_.push_back({s.level - 1, {2 * s.cell[0] + child % 2, 2 * s.cell[1] + child / 2 % 2, 2 * s.cell[2] + child / 4}});
  }
  return std::nullopt;
}

bool Leaves::Walk::meets(const Subtree& s) const {
  for (size_t d = 0; d < 3; ++d)
    if (s.cell[d] << s.level >= box_.hi[d] || (s.cell[d] + 1) << s.level <= box_.lo[d]) return false;
  return true;
}

std::optional<Subtree> Leaves::larger_leaf(const Subtree& s) const {
  // What is above a cell that is split is split, so the largest that isn't is the leaf.
  std::optional<Subtree> leaf;
  for (Subtree above = s; above.level < coarsest(); leaf = above) {
    ++above.level;
    for (int64_t& c : above.cell) c >>= 1;
    if (is_split(above.level, above.cell)) break;
  }
  return leaf;
}

// Goes down from a cell of a block of tier 0, or from the block, to its leaves.
template <class Sink>
class Leaves::Block {
 public:
  Block(const Leaves& leaves, const Splits::Base& base, const Box& box, Sink& sink)
      : leaves_(leaves), box_{place(box.lo), place(box.hi)}, grid_{place(leaves.reader_.meta().grid.cells())}, base_(base), sink_(sink) {
    for (int child = 0; child < 8; ++child) steps_[static_cast<size_t>(child)] = place({child % 2, child / 2 % 2, child / 4});
  }

  void go(const Subtree& from) {
    for (int level = 1; level <= std::min(leaves_.coarsest(), kBlockLevel); ++level) {
      const int tier = (level - 1) / 2;
      const auto number = static_cast<size_t>(level - 1 - 2 * tier);
      const BlockSplits* splits = &base_.splits;
      if (tier > 0) {
        Index3 above = place(from.cell);
        for (int64_t& a : above) a >>= kBlockLevel - from.level + 2 * tier;
        held_.push_back(leaves_.splits_.get({tier, above}));
        splits = held_.back().get();
      }
      if (number < splits->split.size()) split_[static_cast<size_t>(level)] = &splits->split[number];
    }
    visit(from.level, place(from.cell), 0);
  }

 private:
  Index3 place(const Index3& xyz) const { return {xyz[leaves_.frame_.u], xyz[leaves_.frame_.v], xyz[leaves_.frame_.w]}; }

  bool is_split(int level, const Index3& c) const {
    if (level > leaves_.coarsest()) return true;
    const Bits* bits = split_[static_cast<size_t>(level)];
    return bits != nullptr && bits->get(c[0], c[1], c[2]);
  }

  void visit(int level, const Index3& c, uint32_t code) {
    for (size_t d = 0; d < 3; ++d)
      if (c[d] << level >= box_.hi[d] || (c[d] + 1) << level <= box_.lo[d]) return;
    if (level == 0 || !is_split(level, c)) {
      sink_(code, level, label(level, c));
      return;
    }
    const uint32_t each = uint32_t{1} << (3 * (level - 1));
    for (uint32_t child = 0; child < 8; ++child)
      visit(level - 1, {2 * c[0] + steps_[child][0], 2 * c[1] + steps_[child][1], 2 * c[2] + steps_[child][2]}, code + child * each);
  }

  Label label(int level, const Index3& c) const {
    if (base_.label) return *base_.label;
    const int64_t half = level == 0 ? 0 : int64_t{1} << (level - 1);
    Index3 at;
    for (size_t d = 0; d < 3; ++d) at[d] = std::min((c[d] << level) + half, grid_[d] - 1);
    return base_.window->label(at[0], at[1], at[2]);
  }

  const Leaves& leaves_;
  const struct {
    Index3 lo, hi;
  } box_;
  const Index3 grid_;
  const Splits::Base& base_;
  Sink& sink_;
  std::array<Index3, 8> steps_;
  std::array<const Bits*, kBlockLevel + 1> split_{};
  std::vector<std::shared_ptr<const BlockSplits>> held_;
};

Leaves::Leaves(const GridReader& reader, const Refinement& refinement, const std::filesystem::path& folder, size_t memory)
    : reader_(reader), frame_(reader.meta().frame()), splits_(reader, refinement, folder, memory) {}

bool Leaves::is_split(int level, const Index3& cell) const {
  const int tier = (level - 1) / 2, above = level - 2 * tier;
  RefinedBlock block{tier, {cell[frame_.u], cell[frame_.v], cell[frame_.w]}};
  for (int64_t& a : block.at) a >>= RefinedBlock::kBits - above;
  const auto splits = splits_.get(block);
  const auto number = static_cast<size_t>(above - 1);
  return number < splits->split.size() && splits->split[number].get(cell[frame_.u], cell[frame_.v], cell[frame_.w]);
}

template <class Sink>
void Leaves::visit(const Subtree& s, const Box& box, bool again, Sink&& sink) const {
  if (s.level <= kBlockLevel) {
    const Index3 at{s.cell[frame_.u] >> (kBlockLevel - s.level), s.cell[frame_.v] >> (kBlockLevel - s.level),
                    s.cell[frame_.w] >> (kBlockLevel - s.level)};
    Block<Sink>(*this, *splits_.base(at, again), box, sink).go(s);
    return;
  }
  Index3 at{};
  const Index3 n = reader_.meta().grid.cells();
  for (size_t d = 0; d < 3; ++d) at[d] = std::min((s.cell[d] << s.level) + (int64_t{1} << (s.level - 1)), n[d] - 1);
  sink(0, s.level, splits_.label_of({at[frame_.u], at[frame_.v], at[frame_.w]}));
}

Box Leaves::by_rays(const Box& box) const {
  const auto place = [&](const Index3& xyz) { return Index3{xyz[frame_.u], xyz[frame_.v], xyz[frame_.w]}; };
  return {place(box.lo), place(box.hi)};
}

void Leaves::prepare(const Box& box, int threads, const std::function<void(double share)>& progress) {
  splits_.prepare(by_rays(box), threads, progress);
}

bool Leaves::is_prepared(const Box& box) const { return splits_.is_prepared(by_rays(box)); }

double share_of_walk(const Box& box, const Index3& first) {
  int bit = 0;
  while (int64_t{1} << bit < std::ranges::max(box.hi)) ++bit;
  double share = 0, part = 1;
  for (--bit; bit >= 0; --bit) {
    part /= 8;
    share += part * static_cast<double>((first[0] >> bit & 1) + 2 * (first[1] >> bit & 1) + 4 * (first[2] >> bit & 1));
  }
  return share;
}

void Leaves::for_each(const Box& box, int threads, const std::function<void(double share)>& progress,
                      const std::function<void(std::span<const Leaf>)>& take) const {
  struct Found {
    Subtree subtree;
    std::vector<LeafInSubtree> leaves;
  };
  Walk walk(*this, box, kBlockLevel);
  std::vector<Leaf> out;
  in_order(
      threads, [&] { return walk.next(); },
      [&](const Subtree& s, int) {
        Found found{s, {}};
        visit(s, box, false, [&](uint32_t code, int level, Label label) { found.leaves.push_back({code, static_cast<uint8_t>(level), label}); });
        return found;
      },
      [&](const Found& found) {
        const Index3 first = found.subtree.first();
        progress(share_of_walk(box, first));
        constexpr size_t kAtOnce = 1 << 14;
        for (size_t i = 0; i < found.leaves.size(); ++i) {
          const LeafInSubtree& leaf = found.leaves[i];
          const auto level = static_cast<int>(leaf.level);
          const Index3 cell = cell_of_code(leaf.code);
          out.push_back({{(first[0] + cell[0]) >> level, (first[1] + cell[1]) >> level, (first[2] + cell[2]) >> level}, level, leaf.label});
          if (out.size() < kAtOnce) continue;
          take(out);
          out.clear();
        }
      },
      4);
  if (!out.empty()) take(out);
}

LeafCounts Leaves::count(const Box& box, int threads, const std::function<void(double share)>& progress) const {
  struct Found {
    Subtree subtree;
    LeafCounts counts;
  };
  LeafCounts out;
  Walk walk(*this, box, kBlockLevel);
  in_order(
      threads, [&] { return walk.next(); },
      [&](const Subtree& s, int) {
        Found found{s, {}};
        // Leaves that follow each other are mostly alike.
        uint64_t* last = nullptr;
        std::pair<int, Label> what{-1, 0};
        visit(s, box, false, [&](uint32_t, int level, Label label) {
          if (what != std::pair(level, label)) what = {level, label}, last = &found.counts[what];
          ++*last;
        });
        return found;
      },
      [&](const Found& found) {
        progress(share_of_walk(box, found.subtree.first()));
        for (const auto& [what, number] : found.counts) out[what] += number;
      },
      64);
  return out;
}

std::vector<LeafInSubtree> Leaves::leaves_of(const Subtree& s, const Box& box) const {
  std::vector<LeafInSubtree> out;
  visit(s, box, true, [&](uint32_t code, int level, Label label) { out.push_back({code, static_cast<uint8_t>(level), label}); });
  return out;
}

}  // namespace teracell::store
