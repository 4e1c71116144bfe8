// A k-d tree (J. L. Bentley, "Multidimensional Binary Search Trees Used for Associative Searching", 1975) of points. A hash of
// cells would find points near a point, but not points near an edge that is a million times as long as the distance.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "store/grid/grid.hpp"

namespace teracell::mesher {

// Immutable; threads may share it.
class PointTree {
 public:
  // The tree keeps the numbers of the points but not the points.
  explicit PointTree(std::span<const Vec3> points);

  // Calls f(number) for all points within `distance` of the segment a - b, and for some others.
  template <class F>
  void near(const Vec3& a, const Vec3& b, double distance, F&& f) const {
    if (!nodes_.empty()) visit(0, a, b, distance, f);
  }

 private:
  struct Node {
    Vec3 lo, hi;               // the box of its points
    uint32_t first, last;      // in order_
    uint32_t upper;            // the number of its second child (the first one is the next node); 0 for a leaf
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

}  // namespace teracell::mesher
