#include "mesher/planes/segments.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace teracell::mesher {
namespace {

constexpr double kRounding = 1e-9;
constexpr double kSamePlace = 1e-12;   // of the axis's extent
constexpr double kMostChanges = 500;   // of width along an axis, up to which there is a choice of places
constexpr double kSamples = 32;        // of places, over all changes ...
constexpr int kMostSamples = 4;        // ... and for each
constexpr size_t kMostCovered = 4;     // pieces that a segment may reach into, so that a choice takes no time that grows with its square

// The pieces of one gap, which grow at the cost of those whose cells may be wider.
class Gap {
 public:
  Gap(std::vector<WidthPiece> pieces, double shortest, bool roomy) : pieces_(std::move(pieces)), shortest_(shortest), least_(roomy ? shortest : 0) {
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

// Numbers places and adds the segments between them.
class Cutter {
 public:
  Cutter(const Widths& widths, double extent, double finest, double growth, Cutting how)
      : widths_(widths),
        slack_(kSamePlace * extent),
        finest_(finest),
        shortest_(static_cast<double>(cells_of_any_length(growth)) * finest),
        how_(how) {
    const double changes = static_cast<double>(widths.pieces().size());
    if (how == Cutting::kChoice && changes <= kMostChanges) samples_ = std::clamp(static_cast<int>(kSamples / changes), 1, kMostSamples);
  }

  // A gap from lo to hi, of which what lies below `end` is cut: that is all, or the lower half of the gap in the middle of a symmetric axis.
  void cut(double lo, double end, double hi) {
    lo_ = lo, end_ = end, hi_ = hi;
    const std::vector<Place> at = places();
    const size_t first = out_.places - 1;
    for (size_t to = 1; to < at.size(); ++to) add_segments(at, to, first);
    out_.places += at.size() - 1;
  }
  Cuts cuts() && { return std::move(out_); }

 private:
  struct Place {
    double at;
    bool settled;              // there is a plane in any case, unless another choice is better
    size_t below = 0, above = 0;  // the pieces there
  };

  bool is_across() const { return end_ < hi_; }

  std::vector<Place> places() {
    pieces_ = widths_.within(lo_, end_);
    std::vector<Place> out = {{lo_, true}, {end_, true}};
    for (WidthPiece& p : pieces_) p.most = std::max(p.most, finest_);
    if (pieces_.size() == 1) return out;
    for (const WidthPiece& p : Gap(pieces_, shortest_, how_ == Cutting::kRoomy).settle())
      if (p.lo > lo_) out.push_back({p.lo, true});
    if (samples_ > 0)
      for (size_t i = 0; i + 1 < pieces_.size(); ++i) add_choices(i, out);
    std::ranges::sort(out, [](const Place& a, const Place& b) { return std::tuple(a.at, !a.settled) < std::tuple(b.at, !b.settled); });
    const auto same = std::ranges::unique(out, [&](const Place& a, const Place& b) { return !b.settled && b.at - a.at <= slack_; });
    out.erase(same.begin(), same.end());
    size_t piece = 0;
    for (Place& p : out) {
      while (piece + 1 < pieces_.size() && pieces_[piece].hi <= p.at + slack_) ++piece;
      p.above = piece;
      p.below = piece > 0 && pieces_[piece].lo >= p.at - slack_ ? piece - 1 : piece;
    }
    return out;
  }

  // Cells of the narrower of two pieces reach into the wider one, by no more than one of them: so far that the piece, or all from the gap's end on,
  // is a whole number of its widest cells long; by a part of that, as they reach beyond the piece's other end too; or by a part of a cell.
  void add_choices(size_t i, std::vector<Place>& out) const {
    const bool up = pieces_[i].most < pieces_[i + 1].most;
    const WidthPiece& narrow = pieces_[up ? i : i + 1];
    const double at = pieces_[i].hi;
    const auto add = [&](double by) {
      const double place = up ? at + by : at - by;
      if (place > lo_ + finest_ * (1 - kRounding) && place < std::min(end_, hi_ - finest_ * (1 - kRounding))) out.push_back({place, false});
    };
    const auto missing = [&](double length) { return std::max(0.0, std::ceil(length / narrow.most - kRounding) * narrow.most - length); };
    const double own = missing(is_across() && narrow.hi == end_ ? hi_ - (narrow.lo - lo_) - narrow.lo : narrow.hi - narrow.lo);
    for (int k = 0; k <= 4; ++k) add(own * k / 4);
    add(missing(up ? at - lo_ : hi_ - at));
    for (int k = 1; k < samples_; ++k) add(narrow.most * k / samples_);
  }

  // From all places that are near enough below.
  void add_segments(const std::vector<Place>& at, size_t to, size_t first) {
    const bool across = is_across() && to + 1 == at.size();
    size_t usual = to - 1;  // what there is without a choice
    while (!at[usual].settled) --usual;
    size_t piece = at[to].below;
    double most = pieces_[piece].most;
    for (size_t from = to; from-- > 0;) {
      while (piece > at[from].above) most = std::min(most, pieces_[--piece].most);
      const bool is_usual = at[to].settled && from == usual, is_choice = samples_ > 0 && at[to].below < at[from].above + kMostCovered;
      if (from < usual && !is_choice) break;
      if (!is_usual && !is_choice) continue;
      const double lo = at[from].at, hi = across ? hi_ - (lo - lo_) : at[to].at, length = hi - lo;
      const double uniform = length / std::max(1.0, std::floor(length / finest_ + kRounding));
      const bool breaks_finest = length<finest_ * (1 - kRounding), breaks_width = uniform> most * (1 + kRounding);
      if (!is_usual && (breaks_finest || breaks_width)) continue;
      out_.segments.push_back({lo, hi, widest_cell(length, std::max(std::min(most, length), uniform)), first + from, first + to, from == 0,
                               hi_ - lo_ < shortest_ * (1 - kRounding), breaks_width, across});
    }
  }

  // What is a whole number of cells long, but for rounding, is that number of cells.
  static double widest_cell(double length, double most) {
    const double cells = std::round(length / most);
    return length > cells * most && length <= cells * most * (1 + kRounding / 2) ? length / cells : most;
  }

  const Widths& widths_;
  const double slack_, finest_, shortest_;
  const Cutting how_;
  int samples_ = 0;  // of places for a change of width
  double lo_ = 0, end_ = 0, hi_ = 0;
  std::vector<WidthPiece> pieces_;  // up to `end_`
  Cuts out_{.places = 1, .segments = {}};
};

}  // namespace

int64_t cells_of_any_length(double growth) { return std::max<int64_t>(1, static_cast<int64_t>(std::ceil(1 / (growth - 1) - kRounding))); }

Cuts cut_into_segments(const std::vector<double>& kept, const Widths& widths, double finest, double growth, Cutting how,
                       const std::optional<double>& middle) {
  const double extent = kept.back() - kept.front();
  const double near_middle = kSamePlace * extent;
  Cutter cutter(widths, extent, finest, growth, how);
  for (size_t i = 0; i + 1 < kept.size(); ++i) {
    if (middle && kept[i] >= *middle - near_middle) break;
    cutter.cut(kept[i], middle && kept[i + 1] > *middle + near_middle ? *middle : kept[i + 1], kept[i + 1]);
  }
  return std::move(cutter).cuts();
}

}  // namespace teracell::mesher
