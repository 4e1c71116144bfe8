#include "store/grid/grid.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

// Coordinates that the exact predicates can take: products of three of them, and their rounding errors, stay normal.
constexpr double kHuge = 1e75, kTiny = 1e-75;
bool usable(double x) { return x == 0 || (std::abs(x) <= kHuge && std::abs(x) >= kTiny); }

}  // namespace

Axis Axis::uniform(double min, double step, int64_t first, int64_t cells, double sample) {
  Axis a;
  a.min_ = min + 0.0;
  a.step_ = step;
  a.first_ = first;
  a.cells_ = cells;
  a.sample_ = sample;
  a.check();
  return a;
}

Axis Axis::graded(std::vector<double> planes, double sample) {
  if (planes.size() < 2) throw UsageError(fmt::format("a graded axis needs at least 2 planes, found {}", planes.size()));
  Axis a;
  for (double& p : planes) p += 0.0;  // -0 is +0
  a.min_ = planes.front();
  a.sample_ = sample;
  a.cells_ = static_cast<int64_t>(planes.size()) - 1;
  a.planes_ = std::move(planes);
  a.check();
  return a;
}

void Axis::check() const {
  if (cells_ < 1 || cells_ > kMaxCells) throw UsageError(fmt::format("an axis has 1 to {} cells, found {}", kMaxCells, cells_));
  if (!(sample_ >= 0 && sample_ < 1)) throw UsageError(fmt::format("sample must be in [0, 1), found {}", sample_));
  if (!is_graded()) {
    if (!(step_ > 0) || !usable(step_) || !usable(min_))
      throw UsageError(fmt::format("an axis needs a finite min and a step in [1e-75, 1e75], found min {} step {}", min_, step_));
    if (first_ < 0 || first_ > (int64_t{1} << 52)) throw UsageError(fmt::format("first cell {} is outside [0, 2^52]", first_));
    const double top = std::max(std::abs(centre(0)), std::abs(centre(cells_ - 1)));
    if (!(top <= kHuge)) throw UsageError(fmt::format("coordinate {} is beyond 1e75", top));
    // A centre has at most 3 rounding errors of the largest term: neighbours that are 16 of them apart can't meet.
    const double ulp = std::max({top, std::abs(min_), (static_cast<double>(first_ + cells_)) * step_}) * 0x1p-52;
    if (!usable(sample_ * step_)) throw UsageError(fmt::format("sample {} of a step of {} is below 1e-75", sample_, step_));
    if (step_ > 16 * ulp) return;
    // Centres this close are compared one by one: a file of a kilobyte must not make that take hours.
    constexpr int64_t kMaxWalk = 1 << 24;
    if (cells_ > kMaxWalk) throw UsageError(fmt::format("{} cells of {} lie too close together for doubles around {}", cells_, step_, top));
  }
  for (int64_t i = 0; i < cells_; ++i) {
    if (is_graded() && (!std::isfinite(planes_[i + 1]) || !(planes_[i] < planes_[i + 1])))
      throw UsageError(fmt::format("planes must ascend strictly: plane {} is {}, plane {} is {}", i, planes_[i], i + 1, planes_[i + 1]));
    if (!usable(centre(i))) throw UsageError(fmt::format("centre {} of cell {} is outside 1e-75..1e75", centre(i), i));
    if (i > 0 && !(centre(i - 1) < centre(i)))
      throw UsageError(fmt::format("cell centres must ascend strictly: cells {} and {} both lie at {}: the cells are too small for doubles there",
                                   i - 1, i, centre(i)));
  }
}

double Axis::shortest_cell() const {
  if (!is_graded()) return step_;
  double shortest = planes_[1] - planes_[0];
  for (size_t i = 2; i < planes_.size(); ++i) shortest = std::min(shortest, planes_[i] - planes_[i - 1]);
  return shortest;
}

double Axis::longest_cell() const {
  if (!is_graded()) return step_;
  double longest = 0;
  for (size_t i = 1; i < planes_.size(); ++i) longest = std::max(longest, planes_[i] - planes_[i - 1]);
  return longest;
}

int64_t Axis::first_centre_from(double x) const {
  if (is_graded()) {
    int64_t lo = 0, hi = cells_;
    while (lo < hi) {
      const int64_t mid = (lo + hi) / 2;
      if (centre(mid) < x) lo = mid + 1;
      else hi = mid;
    }
    return lo;
  }
  const double guess = (x - min_) / step_ - sample_ - static_cast<double>(first_);
  int64_t i = static_cast<int64_t>(std::clamp(guess, 0.0, static_cast<double>(cells_)));
  while (i < cells_ && centre(i) < x) ++i;
  while (i > 0 && centre(i - 1) >= x) --i;
  return i;
}

int64_t Axis::cell_at(double x) const {
  if (!is_graded()) {
    auto i = static_cast<int64_t>(std::clamp((x - min_) / step_ - static_cast<double>(first_), 0.0, static_cast<double>(cells_ - 1)));
    while (i + 1 < cells_ && plane(i + 1) <= x) ++i;  // the division was rounded
    while (i > 0 && plane(i) > x) --i;
    return i;
  }
  int64_t lo = 0, hi = cells_ - 1;  // the last cell whose lower plane is at or below x
  while (lo < hi) {
    const int64_t mid = (lo + hi + 1) / 2;
    if (plane(mid) <= x) lo = mid;
    else hi = mid - 1;
  }
  return lo;
}

Index3 Grid::cells(int level) const {
  Index3 n = cells();
  for (int64_t& c : n) c = ceil_shift(c, level);
  return n;
}

int Grid::levels() const {
  int level = 0;
  while (cells(level) != Index3{1, 1, 1}) ++level;
  return level + 1;
}

void Grid::check_level(int level) const {
  if (level < 0 || level >= levels()) throw UsageError(fmt::format("level must be 0 to {}, found {}", levels() - 1, level));
}

std::string cell_count_text(const Index3& cells) { return whole_text(static_cast<unsigned __int128>(cells[0]) * cells[1] * cells[2]); }

}  // namespace teracell::store
