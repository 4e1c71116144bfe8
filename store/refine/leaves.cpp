#include "store/refine/leaves.hpp"

#include <algorithm>

#include "store/base/in_order.hpp"

namespace teracell::inline store {
namespace {

constexpr int kBlockLevel = RefinedBlock::kBits;  // of a block of tier 0 as one cell

// A leaf within its block: the Morton code of its first cell there, and its level.
struct Packed {
  uint32_t code : 24, level : 8;
  Label label;
};

// Every third bit of a Morton code.
uint32_t every_third(uint32_t code) {
  code &= 0x09249249;
  code = (code | code >> 2) & 0x030c30c3;
  code = (code | code >> 4) & 0x0300f00f;
  code = (code | code >> 8) & 0x030000ff;
  return (code | code >> 16) & 0x000003ff;
}

}  // namespace

// A block of tier 0, or with level > kBlockLevel a leaf that holds several: as a cell of that level, by x, y, z.
struct Leaves::Job {
  int level;
  Index3 cell;
};

// The blocks and larger leaves that meet a box, in Morton order.
class Leaves::Jobs {
 public:
  Jobs(const Leaves& leaves, const Box& box) : leaves_(leaves), box_(box) {
    int root = std::max(kBlockLevel, leaves.coarsest());
    for (int64_t d = 0; d < 3; ++d)
      while (int64_t{1} << root < leaves.reader_.meta().grid.cells()[static_cast<size_t>(d)]) ++root;
    waiting_.push_back({root, {0, 0, 0}});
  }

  std::optional<Job> next() {
    while (!waiting_.empty()) {
      const Job job = waiting_.back();
      waiting_.pop_back();
      if (!meets(job)) continue;
      if (job.level == kBlockLevel || (job.level <= leaves_.coarsest() && !leaves_.is_split(job.level, job.cell))) return job;
      for (int child = 7; child >= 0; --child)
        waiting_.push_back({job.level - 1, {2 * job.cell[0] + child % 2, 2 * job.cell[1] + child / 2 % 2, 2 * job.cell[2] + child / 4}});
    }
    return std::nullopt;
  }

 private:
  bool meets(const Job& job) const {
    for (size_t d = 0; d < 3; ++d)
      if (job.cell[d] << job.level >= box_.hi[d] || (job.cell[d] + 1) << job.level <= box_.lo[d]) return false;
    return true;
  }

  const Leaves& leaves_;
  const Box box_;
  std::vector<Job> waiting_;
};

// Goes down from a block to its leaves.
template <class Sink>
class Leaves::Block {
 public:
  Block(const Leaves& leaves, const Index3& at, const Box& box, Sink& sink)
      : leaves_(leaves), box_{place(box.lo), place(box.hi)}, grid_{place(leaves.reader_.meta().grid.cells())}, base_(leaves.splits_.base(place(at))), sink_(sink) {
    for (int child = 0; child < 8; ++child) steps_[static_cast<size_t>(child)] = place({child % 2, child / 2 % 2, child / 4});
    for (int level = 1; level <= std::min(leaves.coarsest(), kBlockLevel); ++level) {
      const int tier = (level - 1) / 2;
      const auto number = static_cast<size_t>(level - 1 - 2 * tier);
      const BlockSplits* splits = &base_.splits;
      if (tier > 0) {
        Index3 above = place(at);
        for (int64_t& a : above) a >>= 2 * tier;
        held_.push_back(leaves.splits_.get({tier, above}));
        splits = held_.back().get();
      }
      if (number < splits->split.size()) split_[static_cast<size_t>(level)] = &splits->split[number];
    }
    visit(kBlockLevel, place(at), 0);
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
  const Splits::Base base_;
  Sink& sink_;
  std::array<Index3, 8> steps_;
  std::array<const Bits*, kBlockLevel + 1> split_{};
  std::vector<std::shared_ptr<const BlockSplits>> held_;
};

Leaves::Leaves(const GridReader& reader, const Refinement& refinement, const std::filesystem::path& folder)
    : reader_(reader), frame_(reader.meta().frame()), splits_(reader, refinement, folder) {}

bool Leaves::is_split(int level, const Index3& cell) const {
  const int tier = (level - 1) / 2, above = level - 2 * tier;
  RefinedBlock block{tier, {cell[frame_.u], cell[frame_.v], cell[frame_.w]}};
  for (int64_t& a : block.at) a >>= RefinedBlock::kBits - above;
  const auto splits = splits_.get(block);
  const auto number = static_cast<size_t>(above - 1);
  return number < splits->split.size() && splits->split[number].get(cell[frame_.u], cell[frame_.v], cell[frame_.w]);
}

template <class Sink>
void Leaves::visit(const Job& job, const Box& box, Sink&& sink) const {
  if (job.level == kBlockLevel) {
    Block<Sink>(*this, job.cell, box, sink);
    return;
  }
  Index3 at{};
  const Index3 n = reader_.meta().grid.cells();
  for (size_t d = 0; d < 3; ++d) at[d] = std::min((job.cell[d] << job.level) + (int64_t{1} << (job.level - 1)), n[d] - 1);
  sink(0, job.level, splits_.label_of({at[frame_.u], at[frame_.v], at[frame_.w]}));
}

void Leaves::prepare(const Box& box, int threads, const std::function<void(double share)>& progress) {
  const auto place = [&](const Index3& xyz) { return Index3{xyz[frame_.u], xyz[frame_.v], xyz[frame_.w]}; };
  splits_.prepare({place(box.lo), place(box.hi)}, threads, progress);
}

namespace {

// How far a walk in Morton order over a box has come.
double share_of(const Box& box, const Index3& first) {
  const double size = static_cast<double>(std::max<int64_t>(1, box.hi[2] - box.lo[2]));
  return std::clamp(static_cast<double>(first[2] - box.lo[2]) / size, 0.0, 1.0);
}

}  // namespace

void Leaves::for_each(const Box& box, int threads, const std::function<void(double share)>& progress,
                      const std::function<void(std::span<const Leaf>)>& take) const {
  struct Found {
    Job job;
    std::vector<Packed> leaves;
  };
  Jobs jobs(*this, box);
  std::vector<Leaf> out;
  in_order(
      threads, [&] { return jobs.next(); },
      [&](const Job& job, int) {
        Found found{job, {}};
        visit(job, box, [&](uint32_t code, int level, Label label) { found.leaves.push_back({code, static_cast<uint8_t>(level), label}); });
        return found;
      },
      [&](const Found& found) {
        const Index3 first{found.job.cell[0] << found.job.level, found.job.cell[1] << found.job.level, found.job.cell[2] << found.job.level};
        progress(share_of(box, first));
        constexpr size_t kAtOnce = 1 << 14;
        for (size_t i = 0; i < found.leaves.size(); ++i) {
          const Packed& leaf = found.leaves[i];
          const int level = static_cast<int>(leaf.level);
          out.push_back({{(first[0] + every_third(leaf.code)) >> level, (first[1] + every_third(leaf.code >> 1)) >> level,
                          (first[2] + every_third(leaf.code >> 2)) >> level},
                         level,
                         leaf.label});
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
    Job job;
    LeafCounts counts;
  };
  LeafCounts out;
  Jobs jobs(*this, box);
  in_order(
      threads, [&] { return jobs.next(); },
      [&](const Job& job, int) {
        Found found{job, {}};
        // Leaves that follow each other are mostly alike.
        uint64_t* last = nullptr;
        std::pair<int, Label> what{-1, 0};
        visit(job, box, [&](uint32_t, int level, Label label) {
          if (what != std::pair(level, label)) what = {level, label}, last = &found.counts[what];
          ++*last;
        });
        return found;
      },
      [&](const Found& found) {
        progress(share_of(box, {found.job.cell[0] << found.job.level, found.job.cell[1] << found.job.level, found.job.cell[2] << found.job.level}));
        for (const auto& [what, number] : found.counts) out[what] += number;
      },
      64);
  return out;
}

}  // namespace teracell::store
