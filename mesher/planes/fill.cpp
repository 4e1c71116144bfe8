#include "mesher/planes/fill.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include "mesher/planes/geometric.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

constexpr double kSlack = 1e-12;  // relative
constexpr double kWork = 20000;  // ways that may be followed, over all segments

struct Interval {
  double lo, hi;
  bool empty() const { return !(lo <= hi * (1 + kSlack)); }
  double clamp(double v) const { return std::min(std::max(v, lo), hi); }
  double middle() const { return lo + (hi - lo) / 2; }
};

// Where an increasing function becomes 0: the larger of two values that are next to each other, or the lower end. REQUIRES: it is at least 0 at the
// upper end. (False position, with the weight of an end that stays halved.)
template <class F>
Interval root_of(Interval in, F&& f) {
  double low = f(in.lo), high = f(in.hi);
  if (low >= 0) return {in.lo, in.lo};
  for (int i = 0, stays = 0; i < 60 && in.hi - in.lo > kSlack * in.hi; ++i) {
    double at = i % 4 == 3 ? in.middle() : in.lo - low * ((in.hi - in.lo) / (high - low));
    if (!(at > in.lo && at < in.hi)) at = in.middle();
    if (const double value = f(at); value >= 0) {
      in.hi = at, high = value;
      if (stays > 0) low /= 2;
      stays = std::max(stays, 0) + 1;
    } else {
      in.lo = at, low = value;
      if (stays < 0) high /= 2;
      stays = std::min(stays, 0) - 1;
    }
  }
  return in;
}
// Of the values of an interval those from which on, and up to which, an increasing function is at least 0, and at most 0.
template <class F>
double first_above(const Interval& in, F&& f) {
  return root_of(in, f).hi;
}
template <class F>
double last_below(const Interval& in, F&& f) {
  return f(in.hi) <= 0 ? in.hi : root_of(in, f).lo;
}

// Rows of cells that fill a segment.
struct Row {
  double length, most;
  double least;                 // the width that no cell is below
  double first_most, last_most; // what the surroundings allow its ends
  bool may_break;               // at its lower end the growth may be exceeded

  // Above 0 where no row of these ends is short enough; below 0 where none is long enough.
  double excess(const Growth& g, double first, double last, int64_t n) const {
    return narrowest_length(g, first, last, least, n) - length * (1 + kSlack);
  }
  double reserve(const Growth& g, double first, double last, int64_t n) const {
    return widest_length(g, first, last, most, n) - length * (1 - kSlack);
  }
  // The widths that the last of n cells can have when the first is in an interval.
  Interval reach(const Growth& g, const Interval& first, int64_t n) const {
    if (n == 1) {
      const bool fits = length >= first.lo * (1 - kSlack) && length <= first.hi * (1 + kSlack) && length <= last_most * (1 + kSlack);
      return fits ? Interval{length, length} : kNone;
    }
    const double far = g.power(n - 1);
    const Interval last = {std::max(least, first.lo / far), std::min(last_most, first.hi * far)};
    return solved(
        last, [&](double b) { return excess(g, std::min(std::max(first.lo, b / far), first.hi), b, n); },
        [&](double b) { return reserve(g, std::max(std::min(first.hi, b * far), first.lo), b, n); });
  }
  // The widths that the first of n cells can have when the last has this one.
  Interval back(const Growth& g, const Interval& first, double last, int64_t n) const {
    if (n == 1) return {length, length};
    const double far = g.power(n - 1);
    const Interval found = solved(
        {std::max(first.lo, last / far), std::min(first.hi, last * far)}, [&](double a) { return excess(g, a, last, n); },
        [&](double a) { return reserve(g, a, last, n); });
    return found.empty() ? Interval{first.clamp(last), first.clamp(last)} : found;  // it is empty by rounding alone
  }
  // The widths that both ends of n cells can have when they are equal.
  Interval both(const Growth& g, const Interval& first, int64_t n) const {
    if (n == 1) return reach(g, first, 1);
    return solved(
        {std::max(first.lo, least), std::min(first.hi, last_most)}, [&](double a) { return excess(g, a, a, n); },
        [&](double a) { return reserve(g, a, a, n); });
  }
  // The fewest cells of which the widest row is long enough.
  int64_t fewest(const Growth& g, double first, double last) const {
    int64_t lo = 1, hi = 1;
    const auto enough = [&](int64_t n) { return widest_between(g, first, last, n) >= length * (1 - kSlack); };
    while (!enough(hi)) lo = hi + 1, hi *= 2;
    while (lo < hi) {
      const int64_t middle = lo + (hi - lo) / 2;
      if (enough(middle)) hi = middle;
      else lo = middle + 1;
    }
    return lo;
  }

 private:
  static constexpr Interval kNone = {1, 0};
  // Where the first function is at most 0 and the second at least 0. Both increase.
  template <class F, class G>
  static Interval solved(const Interval& in, F&& excess, G&& reserve) {
    if (in.empty() || excess(in.lo) > 0 || reserve(in.hi) < 0) return kNone;
    return {first_above(in, reserve), last_below(in, excess)};
  }
  // Of ends no wider than these.
  double widest_between(const Growth& g, double first, double last, int64_t n) const {
    const double far = g.power(n - 1);
    const double a = std::min(first, last * far), b = std::min(last, first * far);
    return n == 1 ? std::min(a, b) : widest_length(g, a, b, most, n);
  }
};

// The cells of a segment, once the ends of its row are chosen.
struct Choice {
  size_t segment;
  int64_t cells;
  double first, last;
};

// Ways to fill the axis up to some place with so many cells in all; the last of them can have any width of an interval.
struct Way {
  int64_t breaches;
  int64_t cells;  // of a symmetric axis whose middle a row lies across: of all of it
  Interval last;
  size_t segment;   // the last one
  size_t before;    // the way up to its lower end
  int64_t in_last;  // its cells
  bool breaks;      // at its lower end the growth is exceeded
};

const Way kStart = {0, 0, {0, HUGE_VAL}, 0, 0, 0, false};

// No cell is narrower, but for the rounding of places.
double least_width(const Segment& s, double finest) {
  return std::min(finest, s.length() / std::max(1.0, std::floor(s.length() / finest * (1 + 1e-9))));
}

class Filling {
 public:
  Filling(const Cuts& cuts, double finest, const Growth& growth) : growth_(growth), segments_(cuts.segments), into_(cuts.places + 1) {
    std::vector<bool> after_short(cuts.places);  // the gap below the place
    for (const Segment& s : segments_) {
      after_short[s.to] = s.in_short_gap;
      rows_.push_back({s.length(), s.most, least_width(s, finest), s.most, s.most, s.at_candidate && (s.in_short_gap || after_short[s.from])});
      ++into_[s.to + 1];
    }
    std::partial_sum(into_.begin(), into_.end(), into_.begin());
    limit_ends();
  }

  // As few cells as possible; nothing where no way was found. Fewer cells here may mean more of them there, the more so the slower widths grow, so
  // ways with some more cells are followed as well.
  std::optional<std::vector<Choice>> choose(bool persistent) const {
    const auto affordable = static_cast<int64_t>(kWork / static_cast<double>(into_.size()));
    const int64_t usual = std::clamp<int64_t>(affordable, 2, std::min<int64_t>(cells_of_any_length(growth_.factor) + 2, 10));
    std::optional<std::vector<Choice>> out;
    for (int64_t spare = usual; !out && spare <= (persistent ? 4 * usual : usual); spare *= 2) out = choose_within(spare);
    return out;
  }

  // Rows of equal cells as narrow as can be: neighbours don't differ by more than the growth where segments are long enough for it. REQUIRES: there
  // is one segment to each place.
  std::vector<Choice> uniform() const {
    std::vector<Choice> out;
    for (const Row& r : rows_) {
      const auto cells = std::max<int64_t>(1, static_cast<int64_t>(std::floor(r.length / r.least * (1 + 1e-9))));
      out.push_back({out.size(), cells, r.length / static_cast<double>(cells), r.length / static_cast<double>(cells)});
    }
    return out;
  }

 private:
  // A sequence of cells that starts with width w and fills the length ends with no more than w + (factor - 1) / factor * (length - w).
  double widest_end(double start, double length) const { return std::max(start, (start + length * (growth_.factor - 1)) / growth_.factor); }
  static double least_end(const Row& row) { return row.length / std::max(1.0, std::floor(row.length / row.least * (1 + 1e-9))); }

  // Neighbours limit the ends of rows, from both sides. At places where the growth may break they don't fall below what whole cells can be.
  void limit_ends() {
    const double g = growth_.factor;
    std::vector<double> widest(into_.size());  // of the cells that end at a place
    widest[0] = HUGE_VAL;
    for (size_t i = 0; i < rows_.size(); ++i) {
      Row& r = rows_[i];
      r.first_most = std::min(r.first_most, std::max(widest[segments_[i].from] * g, least_end(r)));
      r.last_most = std::min(r.last_most, widest_end(r.first_most, r.length));
      widest[segments_[i].to] = std::max(widest[segments_[i].to], r.last_most);
    }
    std::ranges::fill(widest, 0);  // of the cells that begin there
    widest[into_.size() - 2] = HUGE_VAL;
    for (size_t i = rows_.size(); i-- > 0;) {
      Row& r = rows_[i];
      r.last_most = std::min(r.last_most, std::max(widest[segments_[i].to] * g, least_end(r)));
      r.first_most = std::min(r.first_most, widest_end(r.last_most, r.length));
      widest[segments_[i].from] = std::max(widest[segments_[i].from], r.first_most);
    }
  }

  Interval firsts(size_t row, const Way& before, bool breaks) const {
    const Row& r = rows_[row];
    if (breaks) return {r.least, r.first_most};
    return {std::max(r.least, before.last.lo / growth_.factor), std::min(r.first_most, before.last.hi * growth_.factor)};
  }

  void extend(size_t row, const std::vector<Way>& before, bool breaks, int64_t spare, int64_t& least, std::vector<Way>& out) const {
    const Row& r = rows_[row];
    const bool equal_ends = segments_[row].across_middle;
    for (size_t w = 0; w < before.size(); ++w) {
      const Way& way = before[w];
      const Interval first = firsts(row, way, breaks);
      if (first.empty()) continue;
      const int64_t breaches = way.breaches + breaks + segments_[row].breaks_width;
      const int64_t fewest = r.fewest(growth_, first.hi, equal_ends ? std::min(first.hi, r.last_most) : r.last_most);
      const int64_t cells = equal_ends ? 2 * way.cells : way.cells;
      for (int64_t n = fewest; n <= fewest + spare && cells + n <= least + spare; ++n) {
        const Interval last = equal_ends ? r.both(growth_, first, n) : r.reach(growth_, first, n);
        if (!last.empty()) {
          out.push_back({breaches, cells + n, last, row, w, n, breaks});
          if (breaches == 0) least = std::min(least, cells + n);
        } else if (n > 1 && r.excess(growth_, std::max(r.least, first.lo), r.least, n) > 0) break;
      }
    }
  }

  // The best first. A way is of no use where another of no more breaches and cells reaches as much.
  static void prune(std::vector<Way>& ways, int64_t spare) {
    std::ranges::stable_sort(ways, [](const Way& a, const Way& b) {
      return std::tie(a.breaches, a.cells, b.last.hi, a.last.lo) < std::tie(b.breaches, b.cells, a.last.hi, b.last.lo);
    });
    std::vector<Way> out;
    for (const Way& way : ways) {
      if (way.breaches > ways.front().breaches + 2 || way.cells > ways.front().cells + spare) continue;
      const auto has_it = [&](const Way& kept) {
        return kept.cells <= way.cells && kept.last.lo <= way.last.lo * (1 + kSlack) && kept.last.hi * (1 + kSlack) >= way.last.hi;
      };
      if (std::ranges::none_of(out, has_it)) out.push_back(way);
    }
    ways = std::move(out);
  }

  std::optional<std::vector<Choice>> choose_within(int64_t most_spare) const {
    std::vector<std::vector<Way>> ways(into_.size() - 1);  // up to each place
    ways[0] = {kStart};
    for (size_t place = 1; place < ways.size(); ++place) {
      int64_t least = std::numeric_limits<int64_t>::max() / 2;  // cells of a way without a breach
      const bool has_choice = into_[place + 1] - into_[place] > 1;  // which gives more ways than a few more cells do
      const int64_t spare = has_choice ? std::min<int64_t>(most_spare, 2) : most_spare;
      for (size_t i = into_[place]; i < into_[place + 1]; ++i) {
        const std::vector<Way>& before = ways[segments_[i].from];
        extend(i, before, false, spare, least, ways[place]);
        if (segments_[i].from > 0 && rows_[i].may_break) extend(i, before, true, spare, least, ways[place]);
      }
      prune(ways[place], spare);
    }
    if (ways.back().empty()) return std::nullopt;
    return choices(ways);
  }

  // From the last row to the first, each with the ends that those behind it leave.
  std::vector<Choice> choices(const std::vector<std::vector<Way>>& ways) const {
    std::vector<Choice> out;
    const Way* way = ways.back().data();  // the one with the fewest cells
    double last = way->last.middle();
    while (way->in_last > 0) {
      const Segment& s = segments_[way->segment];
      const Row& row = rows_[way->segment];
      const Way& before = ways[s.from][way->before];
      last = way->last.clamp(last);
      const Interval first = firsts(way->segment, before, way->breaks);
      const double a = s.across_middle ? last : first.clamp(row.back(growth_, first, last, way->in_last).middle());
      const bool single = way->in_last == 1;
      out.push_back({way->segment, way->in_last, single ? row.length : a, single ? row.length : last});
      last = Interval{std::max(before.last.lo, a / growth_.factor), std::min(before.last.hi, a * growth_.factor)}.clamp(a);
      way = &before;
    }
    std::ranges::reverse(out);
    return out;
  }

  const Growth growth_;
  const std::vector<Segment>& segments_;
  std::vector<size_t> into_;  // the first segment to each place
  std::vector<Row> rows_;
};

// A sum of many widths, without what rounding would take from it.
class Sum {
 public:
  void add(double width) {
    const double w = width - lost_, sum = value_ + w;
    lost_ = (sum - value_) - w;
    value_ = sum;
  }
  double value() const { return value_; }

 private:
  double value_ = 0, lost_ = 0;
};

// Adds the planes after the lower one, up to the upper one.
void add_planes(const Segment& s, const Choice& c, double finest, const Growth& g, std::vector<double>& planes) {
  const double equal = s.length() / static_cast<double>(c.cells);
  if (std::abs(c.first - equal) + std::abs(c.last - equal) < 1e-9 * equal) {
    // Equal cells are written as people would write them.
    const double rounding = 2 * std::numeric_limits<double>::epsilon() * std::max(std::abs(s.lo), std::abs(s.hi));
    const double step = std::abs(s.length() - s.most * static_cast<double>(c.cells)) <= rounding ? s.most : equal;
    for (int64_t i = 1; i < c.cells; ++i) planes.push_back(s.lo + step * static_cast<double>(i));
    planes.push_back(s.hi);
    return;
  }
  // Widths lie between those of the narrowest and the widest row. What rounding leaves goes to cells that may be wider.
  const double least = least_width(s, finest);
  const auto low = [&](int64_t i) { return narrowest(g, c.first, c.last, least, c.cells, i); };
  const auto high = [&](int64_t i) { return widest(g, c.first, c.last, s.most, c.cells, i); };
  const auto is_widest = [&](int64_t i) { return high(i) >= s.most * (1 - 1e-9); };
  Sum lows, highs, widest_cells, at;
  for (int64_t i = 0; i < c.cells; ++i) {
    lows.add(low(i)), highs.add(high(i));
    if (is_widest(i)) widest_cells.add(s.most);
  }
  const double room = highs.value() - lows.value();
  const double share = room > 0 ? std::clamp((s.length() - lows.value()) / room, 0.0, 1.0) : 0;
  const double kept = share == 1 ? widest_cells.value() : 0;
  const double scale = (s.length() - kept) / (lows.value() + share * room - kept);
  for (int64_t i = 0; i + 1 < c.cells; ++i) {
    const double width = share == 1 ? high(i) : low(i) + share * (high(i) - low(i));
    at.add(kept > 0 && is_widest(i) ? s.most : width * scale);
    planes.push_back(s.lo + at.value());
  }
  planes.push_back(s.hi);
}

bool are_mirrored(const std::vector<double>& kept, const Widths& widths) {
  const double sum = kept.front() + kept.back(), slack = 1e-12 * (kept.back() - kept.front());
  for (size_t i = 0; i < kept.size(); ++i)
    if (std::abs(kept[i] + kept[kept.size() - 1 - i] - sum) > slack) return false;
  const auto& p = widths.pieces();
  for (size_t i = 0; i < p.size(); ++i) {
    const WidthPiece& q = p[p.size() - 1 - i];
    if (std::abs(p[i].lo + q.hi - sum) > slack || std::abs(p[i].most - q.most) > kSlack * p[i].most) return false;
  }
  return true;
}

// The planes of the lower half of an axis become those of all of it. The last `in_middle` cells lie in both halves.
void mirror(std::vector<double>& planes, int64_t in_middle, double hi) {
  const double lo = planes.front();
  const bool has_middle_plane = in_middle % 2 == 0;
  planes.resize(planes.size() - static_cast<size_t>(in_middle - in_middle / 2));
  if (in_middle > 0 && has_middle_plane) planes.back() = lo + (hi - lo) / 2;
  for (size_t i = planes.size() - has_middle_plane; i-- > 0;) planes.push_back(hi - (planes[i] - lo));
}

void expect_few(double cells, int64_t most) {
  if (cells <= static_cast<double>(most)) return;
  throw UsageError(fmt::format("expected at most {} cells along an axis, found {:.6g}: make \"finest\" or \"coarsest\" larger", most, cells));
}

}  // namespace

std::vector<double> fill_between(const std::vector<double>& kept, const Widths& widths, double finest, double growth, int64_t most) {
  const Growth g{growth};
  const double lo = kept.front(), hi = kept.back(), middle = lo + (hi - lo) / 2;
  const bool mirrored = are_mirrored(kept, widths);
  const auto half =
      mirrored ? std::optional(middle) : std::nullopt;  // of a symmetric axis the lower half is filled, with what lies across its middle
  double least = 0;  // as few cells as there can be: numbers of them must not overflow
  for (const WidthPiece& p : widths.pieces()) least += (p.hi - p.lo) / std::max(p.most, finest);
  expect_few(least, most);
  Cuts cuts = cut_into_segments(kept, widths, finest, growth, Cutting::kChoice, half);
  auto choices = Filling(cuts, finest, g).choose(false);
  if (!choices) {
    cuts = cut_into_segments(kept, widths, finest, growth, Cutting::kRoomy, half);
    const Filling filling(cuts, finest, g);
    choices = filling.choose(true);
    if (!choices) choices = filling.uniform();
  }
  int64_t cells = 0;
  for (const Choice& c : *choices) cells += c.cells;
  expect_few(static_cast<double>(cells), most);
  std::vector<double> planes = {lo};
  planes.reserve(static_cast<size_t>(mirrored ? 2 * cells : cells) + 1);
  for (const Choice& c : *choices) add_planes(cuts.segments[c.segment], c, finest, g, planes);
  const bool middle_inside = cuts.segments.back().across_middle;
  if (mirrored) mirror(planes, middle_inside ? choices->back().cells : 0, hi);
  // What rounding has moved a little off the place where it belongs.
  const auto put_at = [&](double place, double slack) {
    const auto at = std::ranges::lower_bound(planes, place);
    const auto nearest = at == planes.begin() ? at : at == planes.end() || place - *(at - 1) < *at - place ? at - 1 : at;
    if (std::abs(*nearest - place) <= slack) *nearest = place;
  };
  for (const WidthPiece& p : widths.pieces()) put_at(p.lo, kSlack * (hi - lo));
  for (const double k : kept) put_at(k, hi - lo);
  return planes;
}

}  // namespace teracell::mesher
