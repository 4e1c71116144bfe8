#include "store/compare/difference_counts.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "store/compare/equal_cells.hpp"

namespace teracell::inline store {
namespace {

// The cells of the changes, by their numbers less 1.
class ChangeSums {
 public:
  explicit ChangeSums(const GridReader& a) : shape_(a.shape(0)), frame_(a.meta().frame()) {}
  void add(const FoundChanges& found) {
    for (const LabelStats& l : found.stats) {
      if (l.label == 0) continue;
      if (sums_.size() < l.label) sums_.resize(l.label);
      Sum& sum = sums_[l.label - 1];
      const std::array<int64_t, 3> first = {int64_t{found.key.cu} * shape_.chunk_rays, int64_t{found.key.cv} * shape_.chunk_rays, found.first};
      const std::array<int, 3> axes = {frame_.u, frame_.v, frame_.w};
      for (size_t i = 0; i < 3; ++i) {
        int64_t &lo = sum.box.lo[axes[i]], &hi = sum.box.hi[axes[i]];
        lo = sum.cells == 0 ? first[i] + l.lo[i] : std::min(lo, first[i] + l.lo[i]);
        hi = std::max(hi, first[i] + l.hi[i]);
      }
      sum.cells += l.cells;
    }
  }
  Change change(size_t i, const MaterialNames& names, const ChangeNumbers::Pair& pair) const {
    return {names[pair.from], names[pair.to], sums_[i].cells, sums_[i].box};
  }

 private:
  struct Sum {
    unsigned __int128 cells = 0;
    Box box;
  };
  const LevelShape shape_;
  const RayFrame frame_;
  std::vector<Sum> sums_;
};

}  // namespace

CountedChanges count_changes(const GridReader& a, const GridReader& b, const DifferenceOptions& options, bool with_cells,
                             const std::function<void(const FoundChanges&)>& found, const std::function<void(double)>& progress) {
  expect_equal_cells(a, b);
  const MaterialNames names(a.meta(), b.meta());
  ChangeNumbers numbers(with_cells ? std::min<size_t>(kMostChangeLabels, options.most_changes) : options.most_changes);
  ChangeSums sums(a);
  const GridComparison comparison{a, b, names, numbers, with_cells, options.threads, options.memory, progress, [&](const FoundChanges& changes) {
                                    sums.add(changes);
                                    found(changes);
                                  }};
  if (a.meta().ray_axis == b.meta().ray_axis) compare_along(comparison);
  else compare_across(comparison);

  CountedChanges out;
  Difference& difference = out.difference;
  const Index3 n = a.meta().grid.cells();
  difference.cells = static_cast<unsigned __int128>(n[0]) * static_cast<unsigned __int128>(n[1]) * static_cast<unsigned __int128>(n[2]);
  difference.same = difference.cells;
  std::vector<Change> changes;
  for (size_t i = 0; i < numbers.pairs().size(); ++i) changes.push_back(sums.change(i, names, numbers.pairs()[i]));
  std::vector<uint32_t> order(changes.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](uint32_t i, uint32_t j) {
    const Change &x = changes[i], &y = changes[j];
    return std::tie(y.cells, x.from, x.to) < std::tie(x.cells, y.from, y.to);
  });
  out.label_of.resize(changes.size() + 1);
  for (const uint32_t i : order) {
    difference.same -= changes[i].cells;
    difference.changes.push_back(std::move(changes[i]));
    out.label_of[i + 1] = static_cast<Label>(difference.changes.size());
  }
  return out;
}

Difference count_difference(const GridReader& a, const GridReader& b, const DifferenceOptions& options, const std::function<void(double)>& progress) {
  return count_changes(
             a, b, options, false, [](const FoundChanges&) {}, progress)
      .difference;
}

}  // namespace teracell::store
