#include "mesher/planes/breaches.hpp"

#include <algorithm>

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
    if (width * kOver < rules.finest) add(PlaneBreach::Rule::kFinest, lo, width, rules.finest);
    if (width > most * kOver) add(PlaneBreach::Rule::kWidth, lo, width, most);
    if (const double ratio = std::max(width, before) / std::min(width, before); i > 0 && ratio > rules.growth * kOver)
      add(PlaneBreach::Rule::kGrowth, lo, ratio, rules.growth);
    before = width;
  }
}

}  // namespace teracell::mesher
