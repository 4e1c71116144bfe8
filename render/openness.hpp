// How open the space in front of a point is: hollows are darker. From the share of visible cells in blocks of the grid, blurred.
#pragma once
#include "render/occupancy.hpp"

namespace teracell {

class Openness {
 public:
  // At most kMost blocks along each axis. Keeps a reference to `grid`. What is not below `hi` counts as empty.
  Openness(const Grid& grid, const RayFrame& frame, const Occupancy& occupancy, const Vec3& hi);
  // From 0 to 1, about 0.8 on a plane. `normal` has length 1.
  double at(const Vec3& point, const Vec3& normal) const;

 private:
  static constexpr int64_t kMost = 64;
  double share(const Vec3& blocks) const;
  const Grid& grid_;
  int level_;             // whose cells are the blocks
  Index3 size_{};         // blocks, with an empty one more at each end
  double reach_ = 0;      // a length: the shortest side of a mean block
  std::vector<float> share_;
};

}  // namespace teracell
