#include "mesher/planes/breaches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace teracell::mesher {

void add_breaches(int axis, const std::vector<double>& planes, const std::vector<double>& kept, const Widths& widths, const AutoPlanes& rules,
                  PlanesReport& out) {
  constexpr double kOver = 1 + 1e-9;
  constexpr size_t kMost = 1000;
  const auto add = [&](PlaneBreach::Rule rule, double at, double found, double expected) {
    if (out.breaches.size() < kMost) out.breaches.push_back({axis, rule, at, found, expected});
    else ++out.left_out;
  };
  auto piece = widths.pieces().begin();
  size_t gap = 1;  // its upper end in `kept`
  double before = 0;
  for (size_t i = 0; i + 1 < planes.size(); ++i) {
    const double lo = planes[i], hi = planes[i + 1], width = hi - lo;
    while (gap + 1 < kept.size() && kept[gap] <= lo) ++gap;
    while (piece + 1 != widths.pieces().end() && piece->hi <= lo) ++piece;
    double most = kept[gap] - kept[gap - 1];
    for (auto p = piece; p != widths.pieces().end() && p->lo < hi; ++p) most = std::min(most, p->most);
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(lo), std::abs(hi));  // of both planes
    if (width * kOver + rounding < rules.finest) add(PlaneBreach::Rule::kFinest, lo, width, rules.finest);
    if (width > most * kOver + rounding) add(PlaneBreach::Rule::kWidth, lo, width, most);
    const double wide = std::max(width, before), narrow = std::min(width, before);
    if (i > 0 && wide > narrow * rules.growth * kOver + (1 + rules.growth) * rounding)
      add(PlaneBreach::Rule::kGrowth, lo, wide / narrow, rules.growth);
    before = width;
  }
}

}  // namespace teracell::mesher
