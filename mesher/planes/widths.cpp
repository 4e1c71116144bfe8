#include "mesher/planes/widths.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace teracell::mesher {

Widths::Widths(double lo, double hi, double coarsest, const std::vector<Resolution>& resolutions) {
  std::vector<std::pair<double, size_t>> starts, ends;
  for (size_t i = 0; i < resolutions.size(); ++i) {
    const Resolution& r = resolutions[i];
    if (r.most >= coarsest || r.hi <= lo || r.lo >= hi || r.lo >= r.hi) continue;
    starts.emplace_back(std::max(r.lo, lo), i);
    ends.emplace_back(std::min(r.hi, hi), i);
  }
  std::ranges::sort(starts);
  std::ranges::sort(ends);
  std::multiset<double> here = {coarsest};
  auto start = starts.begin(), end = ends.begin();
  for (double at = lo; at < hi;) {
    for (; end != ends.end() && end->first <= at; ++end) here.erase(here.find(resolutions[end->second].most));
    for (; start != starts.end() && start->first <= at; ++start) here.insert(resolutions[start->second].most);
    double next = hi;
    if (start != starts.end()) next = std::min(next, start->first);
    if (end != ends.end()) next = std::min(next, end->first);
    const double most = *here.begin();
    if (!pieces_.empty() && pieces_.back().most == most) pieces_.back().hi = next;
    else pieces_.push_back({at, next, most});
    at = next;
  }
}

std::vector<WidthPiece> Widths::within(double lo, double hi) const {
  std::vector<WidthPiece> out;
  auto p = std::ranges::upper_bound(pieces_, lo, {}, &WidthPiece::hi);
  for (; p != pieces_.end() && p->lo < hi; ++p) out.push_back({std::max(p->lo, lo), std::min(p->hi, hi), p->most});
  return out;
}

}  // namespace teracell::mesher
