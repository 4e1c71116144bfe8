#include "mesher/planes/flat_faces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace teracell::mesher {

void FlatFaceSearch::take(const std::array<Vec3, 3>& p, double area) {
  if (!std::exchange(began_, true)) first_ = p[0];
  std::array<Vec3, 3> r;
  for (int k = 0; k < 3; ++k)
    for (int d = 0; d < 3; ++d) r[k][d] = p[k][d] - first_[d];
  for (int d = 0; d < 3; ++d) {
    const int u = (d + 1) % 3, v = (d + 2) % 3;
    volume_ += r[0][d] * (r[1][u] * r[2][v] - r[1][v] * r[2][u]) / 6;
    if (slack_[d] < 0) continue;
    const double lo = std::min({p[0][d], p[1][d], p[2][d]}), hi = std::max({p[0][d], p[1][d], p[2][d]});
    if (hi - lo > slack_[d]) {
      least_missed_[d] = std::min(least_missed_[d], hi - lo);
      continue;
    }
    const double across = (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]);
    const auto add = [&](double at, double share) {
      Areas& a = areas_[d][at];
      a.area += area * share, a.facing += across / 2 * share;
    };
    if (lo == hi) add(lo, 1);
    else
      for (const Vec3& q : p) add(q[d], 1.0 / 3);
  }
}

FlatFaces FlatFaceSearch::found() && {
  FlatFaces out{{}, least_missed_, volume_};
  for (int d = 0; d < 3; ++d) {
    for (const auto& [at, a] : areas_[d]) out.axis[d].push_back({at, a.area, a.facing});
    std::ranges::sort(out.axis[d], {}, &FlatArea::at);
  }
  return out;
}

std::vector<FlatArea> grouped(const std::vector<FlatArea>& areas, double slack, double least_area) {
  std::vector<FlatArea> out;
  for (size_t first = 0, end = 0; first < areas.size(); first = end) {
    FlatArea sum{0, 0, 0};
    for (end = first; end < areas.size() && (end == first || areas[end].at - areas[end - 1].at <= slack); ++end)
      sum.area += areas[end].area, sum.facing += areas[end].facing;
    double below = 0;
    size_t median = first;
    for (; median + 1 < end && (below += areas[median].area) < sum.area / 2; ++median) {
    }
    sum.at = areas[median].at;
    if (sum.area >= least_area) out.push_back(sum);
  }
  return out;
}

}  // namespace teracell::mesher
