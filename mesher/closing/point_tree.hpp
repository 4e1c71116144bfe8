// Points in space, searched by box: a k-d tree (J. L. Bentley, 1975). Cells of a hash would do for points near a point, but
// not for points near an edge that is a million times as long as the distance asked for.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "store/grid.hpp"

namespace teracell {

// Immutable; threads may share it.
class PointTree {
 public:
  // Keeps the numbers of the points, not the points.
  explicit PointTree(std::span<const Vec3> points);

  // Calls f(number) for all points at most `distance` from the segment a - b, and for some further ones.
  template <class F>
  void near(const Vec3& a, const Vec3& b, double distance, F&& f) const {
    if (!nodes_.empty()) visit(0, a, b, distance, f);
  }

 private:
  struct Node {
    Vec3 lo, hi;               // the box of its points
    uint32_t first, last;      // in order_
    uint32_t upper;            // its second child; the first one follows it. 0 for a leaf
  };
  uint32_t build(std::span<const Vec3> points, uint32_t first, uint32_t last);
  static bool may_be_near(const Node& node, const Vec3& a, const Vec3& b, double distance);

  template <class F>
  void visit(uint32_t n, const Vec3& a, const Vec3& b, double distance, F&& f) const {
    const Node& node = nodes_[n];
    if (!may_be_near(node, a, b, distance)) return;
    if (node.upper == 0) {
      for (uint32_t i = node.first; i < node.last; ++i) f(order_[i]);
      return;
    }
    visit(n + 1, a, b, distance, f);
    visit(node.upper, a, b, distance, f);
  }

  std::vector<Node> nodes_;
  std::vector<uint32_t> order_;
};

}  // namespace teracell
