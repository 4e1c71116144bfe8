#include "store/read/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>

#include "store/base/error.hpp"
#include "store/base/wanted.hpp"
#include "store/read/query.hpp"
#include "store/read/stats.hpp"

namespace teracell::inline store {
namespace {

// A cell of a level, and the square of the distance to the nearest cell of level 0 in it.
struct Candidate {
  double away;
  int level;
  Index3 cell;
  friend bool operator>(const Candidate& a, const Candidate& b) { return std::tie(a.away, a.level, a.cell) > std::tie(b.away, b.level, b.cell); }
};

using Open = std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>>;

// Of the box. Null where the cell lies beside it.
std::optional<double> distance(const Nearest& what, int level, const Index3& cell) {
  double sum = 0;
  for (int d = 0; d < 3; ++d) {
    const int64_t first = std::max(cell[d] << level, what.box.lo[d]), last = std::min((cell[d] + 1) << level, what.box.hi[d]) - 1;
    if (first > last) return std::nullopt;
    const double off = static_cast<double>(what.to[d] - std::clamp(what.to[d], first, last)) * what.width[static_cast<size_t>(d)];
    sum += off * off;
  }
  return sum;
}

// Opens the cells below that have it.
void open_finer(const Grid& grid, const Nearest& what, const Candidate& coarse, Open& open) {
  const int level = coarse.level - 1;
  const Index3 n = grid.cells(level);
  for (int part = 0; part < 8; ++part) {
    const Index3 cell = {2 * coarse.cell[0] + (part & 1), 2 * coarse.cell[1] + (part >> 1 & 1), 2 * coarse.cell[2] + (part >> 2)};
    if (cell[0] >= n[0] || cell[1] >= n[1] || cell[2] >= n[2]) continue;
    if (const auto away = distance(what, level, cell); away && what.has(level, cell)) open.push({*away, level, cell});
  }
}

}  // namespace

std::optional<Index3> nearest_cell(const Grid& grid, const Nearest& what) {
  double diagonal = 0;  // the square of that of a cell
  for (const double width : what.width) diagonal += width * width;
  Open open;
  open.push({0, grid.levels() - 1, {0, 0, 0}});
  while (!open.empty() && open.size() <= kMostOpen) {
    Wanted::stop_if_not();
    const Candidate best = open.top();
    if (best.level == 0) return best.cell;
    // What is small beside its distance: nothing in it is much farther than the nearest of all.
    if (std::ldexp(diagonal, 2 * best.level) <= what.slack * what.slack * best.away) open = {};
    else open.pop();
    open_finer(grid, what, best, open);
  }
  return std::nullopt;
}

BoxAndNearest read_nearest(const GridReader& reader, const std::vector<bool>& labels, std::optional<Index3> to) {
  const Box box = read_box_of(reader, labels);
  if (box.empty()) return {box, std::nullopt};
  Nearest what{.box = box, .slack = 0.125};
  for (int d = 0; d < 3; ++d) {
    what.to[d] = to ? (*to)[d] : (box.lo[d] + box.hi[d] - 1) / 2;
    what.width[static_cast<size_t>(d)] = 1 / static_cast<double>(box.hi[d] - box.lo[d]);
  }
  what.has = [&](int level, const Index3& cell) {
    bool out = false;
    try {
      for_each_run(reader, level, {cell, {cell[0] + 1, cell[1] + 1, cell[2] + 1}},
                   [&](const BoxRun& run) { out = std::ranges::any_of(*run.set, [&](Label label) { return labels[label]; }); });
    } catch (const FormatError&) {
      out = level > 0;  // below it may be what can be read
    }
    return out;
  };
  return {box, nearest_cell(reader.meta().grid, what)};
}

}  // namespace teracell::store
