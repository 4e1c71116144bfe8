#include "mesher/closing/point_tree.hpp"

#include <algorithm>
#include <numeric>

namespace teracell::mesher {

PointTree::PointTree(std::span<const Vec3> points) : order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (!points.empty()) build(points, 0, static_cast<uint32_t>(points.size()));
}

uint32_t PointTree::build(std::span<const Vec3> points, uint32_t first, uint32_t last) {
  constexpr uint32_t kLeaf = 8;
  Vec3 lo = points[order_[first]], hi = lo;
  for (uint32_t i = first; i < last; ++i)
    for (int d = 0; d < 3; ++d) {
      lo[d] = std::min(lo[d], points[order_[i]][d]);
      hi[d] = std::max(hi[d], points[order_[i]][d]);
    }
  const auto node = static_cast<uint32_t>(nodes_.size());
  nodes_.push_back({lo, hi, first, last, 0});
  if (last - first <= kLeaf) return node;
  int longest = 0;
  for (int d = 1; d < 3; ++d)
    if (hi[d] - lo[d] > hi[longest] - lo[longest]) longest = d;
  const uint32_t middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](uint32_t p, uint32_t q) { return points[p][longest] < points[q][longest]; });
  build(points, first, middle);
  const uint32_t upper = build(points, middle, last);
  nodes_[node].upper = upper;
  return node;
}

// Tests boxes, then the sphere around the node's box. The margins cover the caller's rounding errors as well.
bool PointTree::may_be_near(const Node& node, const Vec3& a, const Vec3& b, double distance) {
  const double reach = distance * 1.0001;
  double radius = 0, along = 0, length = 0;
  Vec3 centre;
  for (int d = 0; d < 3; ++d) {
    if (std::max(a[d], b[d]) + reach < node.lo[d] || std::min(a[d], b[d]) - reach > node.hi[d]) return false;
    centre[d] = node.lo[d] / 2 + node.hi[d] / 2;
    radius += (node.hi[d] - node.lo[d]) * (node.hi[d] - node.lo[d]) / 4;
    along += (centre[d] - a[d]) * (b[d] - a[d]);
    length += (b[d] - a[d]) * (b[d] - a[d]);
  }
  const double t = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0;
  double away = 0, size = 0;
  for (int d = 0; d < 3; ++d) {
    const double x = centre[d] - (a[d] + t * (b[d] - a[d]));
    away += x * x;
    size = std::max({size, std::abs(a[d]), std::abs(b[d]), std::abs(centre[d])});
  }
  return std::sqrt(away) <= (std::sqrt(radius) + reach) * 1.0001 + 0x1p-48 * size;
}

}  // namespace teracell::mesher
