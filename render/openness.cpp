#include "render/openness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace teracell {

Openness::Openness(const Grid& grid, const RayFrame& frame, const Occupancy& occupancy, const Vec3& hi) : grid_(grid), level_(occupancy.level()) {
  while (std::ranges::max(grid.cells(level_)) > kMost) ++level_;
  const int level = level_, fine = std::max(occupancy.level(), level - 3);  // whose cells are counted
  const Index3 blocks = grid.cells(level), cells = grid.cells(fine);
  reach_ = std::numeric_limits<double>::infinity();
  for (int d = 0; d < 3; ++d) {
    size_[d] = blocks[d] + 2;
    const Axis& axis = grid.axis[d];
    reach_ = std::min(reach_, std::ldexp((axis.max() - axis.min()) / static_cast<double>(axis.cells()), level));
  }
  share_.resize(static_cast<size_t>(size_[0] * size_[1] * size_[2]));
  const float one = std::ldexp(1.0f, -3 * (level - fine));
  Index3 at;
  for (at[2] = 0; at[2] < cells[2]; ++at[2])
    for (at[1] = 0; at[1] < cells[1]; ++at[1])
      for (at[0] = 0; at[0] < cells[0]; ++at[0]) {
        bool cut = false;
        for (int d = 0; d < 3; ++d) cut = cut || grid.axis[d].plane(at[d] << fine) >= hi[d];
        const auto cell = [&](int d) { return static_cast<uint32_t>(at[d]); };
        if (cut || !occupancy.at(fine, cell(frame.u), cell(frame.v), cell(frame.w))) continue;
        const auto block = [&](int d) { return (at[d] >> (level - fine)) + 1; };
        share_[static_cast<size_t>((block(2) * size_[1] + block(1)) * size_[0] + block(0))] += one;
      }
  const Index3 stride = {1, size_[0], size_[0] * size_[1]};
  for (int d = 0; d < 3; ++d) {
    std::vector<float> next(share_.size());
    for (int64_t i = 0; i < static_cast<int64_t>(share_.size()); ++i) {
      const int64_t place = i / stride[d] % size_[d];
      const float before = place > 0 ? share_[static_cast<size_t>(i - stride[d])] : 0,
                  after = place + 1 < size_[d] ? share_[static_cast<size_t>(i + stride[d])] : 0;
      next[static_cast<size_t>(i)] = (before + 2 * share_[static_cast<size_t>(i)] + after) / 4;
    }
    share_ = std::move(next);
  }
}

// Between the centres of the blocks.
double Openness::share(const Vec3& blocks) const {
  int64_t lo[3];
  double rest[3];
  for (int d = 0; d < 3; ++d) {
    const double t = std::clamp(blocks[d] - 0.5, 0.0, static_cast<double>(size_[d]) - 1.001);
    lo[d] = static_cast<int64_t>(t);
    rest[d] = t - static_cast<double>(lo[d]);
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    int64_t at[3];
    for (int d = 0; d < 3; ++d) {
      const int up = corner >> d & 1;
      weight *= up ? rest[d] : 1 - rest[d];
      at[d] = lo[d] + up;
    }
    sum += weight * share_[static_cast<size_t>((at[2] * size_[1] + at[1]) * size_[0] + at[0])];
  }
  return sum;
}

double Openness::at(const Vec3& point, const Vec3& normal) const {
  double shut = 0;
  for (const double reach : {0.7, 1.8}) {
    Vec3 blocks;
    for (int d = 0; d < 3; ++d) {
      const Axis& axis = grid_.axis[d];
      const double x = point[d] + normal[d] * reach * reach_;
      const int64_t cell = axis.cell_at(std::clamp(x, axis.min(), axis.max()));
      const double lo = axis.plane(cell), cells = static_cast<double>(cell) + (x - lo) / (axis.plane(cell + 1) - lo);
      blocks[d] = std::ldexp(cells, -level_) + 1;
    }
    shut += share(blocks);
  }
  return std::clamp(1 - 0.75 * shut, 0.0, 1.0);
}

}  // namespace teracell
