#include "server/render/openness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace teracell::server {
namespace {

constexpr int64_t kMost = 64;  // blocks along an axis

}  // namespace

Density::Density(const Grid& grid, const RayFrame& frame, const Occupancy& occupancy) : level_(occupancy.level()) {
  while (std::ranges::max(grid.cells(level_)) > kMost) ++level_;
  const int fine = std::max(occupancy.level(), level_ - 3), shift = level_ - fine;  // whose cells are counted
  const Index3 blocks = grid.cells(level_), cells = grid.cells(fine);
  for (int d = 0; d < 3; ++d) size_[d] = blocks[d] + 2;
  share_.resize(static_cast<size_t>(size_[0] * size_[1] * size_[2]));
  const float one = std::ldexp(1.0f, -3 * shift);
  const uint32_t side = uint32_t{1} << shift;
  const auto nu = static_cast<uint32_t>(cells[frame.u]), nv = static_cast<uint32_t>(cells[frame.v]), nw = static_cast<uint32_t>(cells[frame.w]);
  for (uint32_t v = 0; v < nv; ++v)
    for (uint32_t u = 0; u < nu; ++u)
      for (uint32_t w = 0; w < nw; w += side) {
        Index3 block;
        block[frame.u] = (u >> shift) + 1, block[frame.v] = (v >> shift) + 1, block[frame.w] = (w >> shift) + 1;
        share_[static_cast<size_t>((block[2] * size_[1] + block[1]) * size_[0] + block[0])] +=
            one * static_cast<float>(occupancy.count(fine, u, v, w, side));
      }
}

Openness::Openness(const Grid& grid, const Density& density, const Cuts& cuts)
    : grid_(grid), level_(density.level_), size_(density.size_), reach_(std::numeric_limits<double>::infinity()), share_(density.share_) {
  for (const Axis& axis : grid.axis) reach_ = std::min(reach_, std::ldexp((axis.max() - axis.min()) / static_cast<double>(axis.cells()), level_));
  if (!cuts.empty()) cut(cuts);
  blur();
}

// A block counts as far as the middles of its eight parts remain.
void Openness::cut(const Cuts& cuts) {
  std::array<std::vector<double>, 3> middles;
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = grid_.axis[d];
    for (int64_t block = 0; block + 2 < size_[d]; ++block) {
      const double lo = axis.plane(block << level_), hi = axis.plane(std::min((block + 1) << level_, axis.cells()));
      for (const double share : {0.25, 0.75}) middles[d].push_back(lo + share * (hi - lo));
    }
  }
  for (int64_t z = 0; z + 2 < size_[2]; ++z)
    for (int64_t y = 0; y + 2 < size_[1]; ++y)
      for (int64_t x = 0; x + 2 < size_[0]; ++x) {
        float& share = share_[static_cast<size_t>(((z + 1) * size_[1] + y + 1) * size_[0] + x + 1)];
        if (share == 0) continue;
        int left = 0;
        for (int part = 0; part < 8; ++part) {
          const auto middle = [&](int d, int64_t block) { return middles[d][static_cast<size_t>(2 * block + (part >> d & 1))]; };
          left += !is_cut(cuts, {middle(0, x), middle(1, y), middle(2, z)});
        }
        share *= static_cast<float>(left) / 8;
      }
}

void Openness::blur() {
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

}  // namespace teracell::server
