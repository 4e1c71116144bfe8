#include "mesher/planes/segments.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace teracell::mesher {
namespace {

constexpr double kRounding = 1e-9;

// The pieces of one gap, which grow at the cost of those whose cells may be wider.
class Gap {
 public:
  Gap(std::vector<WidthPiece> pieces, double finest, double shortest, bool roomy)
      : pieces_(std::move(pieces)), shortest_(shortest), least_(roomy ? shortest : 0) {
    for (WidthPiece& p : pieces_) p.most = std::max(p.most, finest);
    const size_t n = pieces_.size();
    before_.resize(n), after_.resize(n), settled_.resize(n), gone_.resize(n);
    for (size_t i = 0; i < n; ++i) before_[i] = i - 1, after_[i] = i + 1;
  }

  std::vector<WidthPiece> settle() {
    std::vector<size_t> order(pieces_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::stable_sort(order, {}, [&](size_t i) { return pieces_[i].most; });
    for (const size_t i : order)
      if (!gone_[i]) settle(i);
    std::vector<WidthPiece> out;
    for (size_t i = 0; i < pieces_.size(); ++i)
      if (!gone_[i]) out.push_back(pieces_[i]);
    return out;
  }

 private:
  bool is_free(size_t i) const { return i < pieces_.size() && !settled_[i]; }

  // It becomes as long as a whole number of its widest cells. What is left of its neighbours is long enough for any number of cells, or nothing.
  void settle(size_t i) {
    WidthPiece& p = pieces_[i];
    for (;;) {
      const size_t l = before_[i], r = after_[i];
      const double more = std::ceil(std::max(p.hi - p.lo, least_) / p.most - kRounding) * p.most - (p.hi - p.lo);
      if ((!is_free(l) && !is_free(r)) || more <= kRounding * p.most) break;
      const double below = !is_free(l) ? 0 : is_free(r) ? more / 2 : more, above = is_free(r) ? more - below : 0;
      const bool takes_l = below > 0 && p.lo - below<pieces_[l].lo + shortest_, takes_r = above> 0 && p.hi + above > pieces_[r].hi - shortest_;
      if (takes_l) swallow(i, l);
      if (takes_r) swallow(i, r);
      if (takes_l || takes_r) continue;
      if (below > 0) p.lo -= below, pieces_[l].hi = p.lo;
      if (above > 0) p.hi += above, pieces_[r].lo = p.hi;
    }
    settled_[i] = true;
    const double cells = (p.hi - p.lo) / p.most;
    const bool whole = least_ == 0 && std::abs(cells - std::round(cells)) < kRounding * std::max(1.0, cells);
    if (whole || p.hi - p.lo >= shortest_ * (1 - kRounding) || (before_[i] >= pieces_.size() && after_[i] >= pieces_.size())) return;
    // Between two that are settled: the one that allows wider cells takes it.
    const size_t l = before_[i], r = after_[i];
    swallow(l >= pieces_.size() || (r < pieces_.size() && pieces_[r].most > pieces_[l].most) ? r : l, i);
  }

  // Piece `other` becomes part of its neighbour i.
  void swallow(size_t i, size_t other) {
    if (other == before_[i]) {
      pieces_[i].lo = pieces_[other].lo;
      before_[i] = before_[other];
      if (before_[i] < pieces_.size()) after_[before_[i]] = i;
    } else {
      pieces_[i].hi = pieces_[other].hi;
      after_[i] = after_[other];
      if (after_[i] < pieces_.size()) before_[after_[i]] = i;
    }
    gone_[other] = true;
  }

  std::vector<WidthPiece> pieces_;
  const double shortest_, least_;
  std::vector<size_t> before_, after_;  // past the end: there is none
  std::vector<bool> settled_, gone_;
};

}  // namespace

int64_t cells_of_any_length(double growth) { return std::max<int64_t>(1, static_cast<int64_t>(std::ceil(1 / (growth - 1) - kRounding))); }

std::vector<Segment> cut_into_segments(const std::vector<double>& kept, const Widths& widths, double finest, double growth, bool roomy) {
  const double shortest = static_cast<double>(cells_of_any_length(growth)) * finest;
  std::vector<Segment> out;
  for (size_t i = 0; i + 1 < kept.size(); ++i) {
    const double lo = kept[i], hi = kept[i + 1];
    std::vector<WidthPiece> pieces = widths.within(lo, hi);
    if (pieces.size() > 1) pieces = Gap(std::move(pieces), finest, shortest, roomy).settle();
    for (const WidthPiece& p : pieces) {
      const double length = p.hi - p.lo;
      const double uniform = length / std::max(1.0, std::floor(length / finest + kRounding));
      out.push_back({p.lo, p.hi, std::max(std::min(p.most, length), uniform), p.lo == lo});
    }
  }
  return out;
}

}  // namespace teracell::mesher
