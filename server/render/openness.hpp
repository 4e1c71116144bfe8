// How open the space in front of a point is: hollows are darker. From the share of visible cells in blocks of the grid, blurred.
#pragma once
#include "server/render/cut.hpp"
#include "server/render/occupancy.hpp"

namespace teracell::server {

// The share of visible cells in the blocks of a grid: cells of a level, at most 64 along each axis.
class Density {
 public:
  Density(const Grid& grid, const RayFrame& frame, const Occupancy& occupancy);
  int level() const { return level_; }
  size_t memory() const { return share_.size() * sizeof(float); }  // bytes on the heap

 private:
  friend class Openness;
  int level_;
  Index3 size_{};             // blocks, with an empty one more at each end
  std::vector<float> share_;  // 0 to 1, x fastest
};

class Openness {
 public:
  // Keeps a reference to `grid`. What is cut away counts as empty.
  Openness(const Grid& grid, const Density& density, const Cuts& cuts);
  // From 0 to 1, about 0.8 on a plane. `normal` has length 1.
  double at(const Vec3& point, const Vec3& normal) const;

 private:
  void cut(const Cuts& cuts);
  void blur();
  double share(const Vec3& blocks) const;
  const Grid& grid_;
  const int level_;
  const Index3 size_;
  double reach_;  // a length: the shortest side of a mean block
  std::vector<float> share_;
};

}  // namespace teracell::server
