#include "mesher/closing/extrude.hpp"

#include <algorithm>
#include <cmath>

#include "mesher/closing/lengths.hpp"

namespace teracell::mesher {
namespace {

double signed_area(const Loop& loop, const RayFrame& f) {
  double sum = 0;
  for (size_t i = 1; i + 1 < loop.size(); ++i)
    sum += (loop[i][f.u] - loop[0][f.u]) * (loop[i + 1][f.v] - loop[0][f.v]) - (loop[i][f.v] - loop[0][f.v]) * (loop[i + 1][f.u] - loop[0][f.u]);
  return sum / 2;
}

// Whether the loop surrounds p as seen along the axis, by the parity of its edges to the right of p.
bool surrounds(const Loop& loop, const RayFrame& f, const Vec3& p) {
  bool inside = false;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    if ((a[f.v] > p[f.v]) == (b[f.v] > p[f.v])) continue;
    inside ^= p[f.u] < a[f.u] + (p[f.v] - a[f.v]) / (b[f.v] - a[f.v]) * (b[f.u] - a[f.u]);
  }
  return inside;
}

}  // namespace

std::vector<bool> outer_loops(const std::vector<Loop>& loops, int axis, bool evenodd) {
  const RayFrame f = RayFrame::along(axis);
  std::vector<double> area;
  std::vector<std::pair<double, double>> extent;  // along v
  std::vector<Vec3> least;
  for (const Loop& loop : loops) {
    area.push_back(signed_area(loop, f));
    least.push_back(*std::ranges::min_element(loop));
    const auto [lowest, highest] = std::ranges::minmax(loop, {}, [&](const Vec3& p) { return p[f.v]; });
    extent.emplace_back(lowest[f.v], highest[f.v]);
  }
  std::vector<bool> out(loops.size(), true);
  if (loops.size() < 2) return out;
  if (evenodd) {
    for (size_t i = 0; i < loops.size(); ++i) {
      const double v = least[i][f.v];
      for (size_t k = 0; k < loops.size() && out[i]; ++k)
        if (std::abs(area[k]) > std::abs(area[i]) && extent[k].first <= v && v <= extent[k].second && surrounds(loops[k], f, least[i]))
          out[i] = false;
    }
    return out;
  }
  size_t largest = 0;
  for (size_t i = 1; i < loops.size(); ++i)
    if (std::abs(area[i]) > std::abs(area[largest]) || (std::abs(area[i]) == std::abs(area[largest]) && least[i] < least[largest])) largest = i;
  for (size_t i = 0; i < loops.size(); ++i) out[i] = (area[i] > 0) == (area[largest] > 0) && (area[i] < 0) == (area[largest] < 0);
  return out;
}

std::array<double, 2> beyond(int axis, const Grid& grid, const Vec3& lo, const Vec3& hi) {
  const Axis& a = grid.axis[axis];
  const double from = std::min(a.min(), lo[axis]), to = std::max(a.max(), hi[axis]);
  return {checked_coordinate(from - (to - from), "the end of extruded walls"), checked_coordinate(to + (to - from), "the end of extruded walls")};
}

void extrude_loop(const Loop& loop, int axis, double to, std::vector<Facet>& walls, std::vector<Hole>& holes) {
  Loop floor = loop;
  for (Vec3& v : floor) v[axis] = to;
  const Vec3 apex = apex_of(floor, false);
  for (size_t i = 0; i < loop.size(); ++i) {
    const size_t k = (i + 1) % loop.size();
    walls.push_back({{loop[k], loop[i], floor[i]}});
    walls.push_back({{loop[k], floor[i], floor[k]}});
    walls.push_back({{floor[k], floor[i], apex}});
  }
  Hole hole = measure_hole(floor, apex);
  Vec3 centre{};
  hole.lo = hole.hi = loop[0];
  for (const Vec3& v : loop) {
    for (int d = 0; d < 3; ++d) centre[d] += v[d] / static_cast<double>(loop.size());
    extend(hole.lo, hole.hi, v);
  }
  hole.at = centre;
  hole.extruded = true;
  holes.push_back(hole);
}

}  // namespace teracell::mesher
