#include "store/read/nearest.hpp"

#include <algorithm>
#include <queue>
#include <tuple>

#include <fmt/format.h>

#include "store/read/query.hpp"
#include "store/read/stats.hpp"

namespace teracell::inline store {
namespace {

constexpr double kSlack = 0.125;

// A cell of a level, and the square of the distance to the nearest cell of level 0 that it may hold.
struct Candidate {
  double away;
  int level;
  Index3 cell;
  friend bool operator<(const Candidate& a, const Candidate& b) { return std::tie(a.away, a.level, a.cell) < std::tie(b.away, b.level, b.cell); }
  friend bool operator>(const Candidate& a, const Candidate& b) { return b < a; }
};

class Search {
 public:
  Search(const GridReader& reader, const std::vector<bool>& labels, const Index3& to)
      : reader_(reader), labels_(labels), to_(to), box_(read_box_of(reader, labels)) {}

  std::optional<Index3> nearest() const {
    if (box_.empty()) return std::nullopt;
    const int top = reader_.meta().grid.levels() - 1;
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> open;
    open.push({0, top, {0, 0, 0}});
    while (true) {
      Candidate best = open.top();
      open.pop();
      // Small beside how far away it is: nothing in it is much farther than the nearest of all, and it holds something.
      while (best.level > 0 && diameter(best.level) <= kSlack * kSlack * best.away) {
        const auto finer = within(best);
        best = *std::min_element(finer.begin(), finer.end());
      }
      if (best.level == 0) return best.cell;
      for (const Candidate& finer : within(best)) open.push(finer);
    }
  }

 private:
  double share(int axis, int64_t cells) const { return static_cast<double>(cells) / static_cast<double>(box_.hi[axis] - box_.lo[axis]); }

  // The square of the longest distance within a cell of a level.
  double diameter(int level) const {
    double sum = 0;
    for (int d = 0; d < 3; ++d) sum += share(d, int64_t{1} << level) * share(d, int64_t{1} << level);
    return sum;
  }

  double away(int level, const Index3& cell) const {
    double sum = 0;
    for (int d = 0; d < 3; ++d) {
      const int64_t first = cell[d] << level, last = std::min((cell[d] + 1) << level, reader_.meta().grid.axis[d].cells()) - 1;
      const double off = share(d, to_[d] - std::clamp(to_[d], first, last));
      sum += off * off;
    }
    return sum;
  }

  // The cells of the level below that a cell holds and that have one of the labels. There is one: a coarse cell has the labels of what it holds.
  std::vector<Candidate> within(const Candidate& coarse) const {
    const int level = coarse.level - 1;
    const Index3 n = reader_.meta().grid.cells(level);
    Box box;
    for (int d = 0; d < 3; ++d) {
      box.lo[d] = 2 * coarse.cell[d];
      box.hi[d] = std::min(box.lo[d] + 2, n[d]);
    }
    std::vector<Candidate> out;
    for_each_run(reader_, level, box, [&](const BoxRun& run) {
      if (!std::ranges::any_of(*run.set, [&](Label label) { return labels_[label]; })) return;
      Index3 cell = run.start;
      for (int64_t i = 0; i < run.length; ++i, ++cell[reader_.meta().ray_axis]) out.push_back({away(level, cell), level, cell});
    });
    if (out.empty())
      throw FormatError(fmt::format("{}: level {}, cell ({}, {}, {}): it has labels that no cell in it has (FORMAT.md 4.1)", reader_.name(),
                                    coarse.level, coarse.cell[0], coarse.cell[1], coarse.cell[2]));
    return out;
  }

  const GridReader& reader_;
  const std::vector<bool>& labels_;
  const Index3 to_;
  const Box box_;
};

}  // namespace

std::optional<Index3> read_nearest(const GridReader& reader, const std::vector<bool>& labels, const Index3& to) {
  return Search(reader, labels, to).nearest();
}

}  // namespace teracell::store
