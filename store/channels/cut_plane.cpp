#include "store/channels/cut_plane.hpp"

#include <algorithm>
#include <cmath>

namespace teracell::inline store {
namespace {

constexpr double kFlat = 1e-8;  // smaller components of a normal are taken as 0: formulas that divide by them lose their digits

// The volume below the plane with constant a <= 1/2. REQUIRES: m ascends, and its sum is 1.
double volume_below(const Vec3& m, double a) {
  const double pair = m[0] + m[1], six = 6 * m[0] * m[1] * m[2];
  const auto cut = [&](double part) { return part * part * (part - 3 * a); };  // of a^2 (3 pair - a) and the like
  if (a < m[0]) return a * a * a / six;
  if (a < m[1]) return a * (a - m[0]) / (2 * m[1] * m[2]) + m[0] * m[0] / (6 * m[1] * m[2]);
  if (a < std::min(pair, m[2])) return (a * a * (3 * pair - a) + cut(m[0]) + cut(m[1])) / six;
  if (m[2] < pair) return (a * a * (3 - 2 * a) + cut(m[0]) + cut(m[1]) + cut(m[2])) / six;
  return (2 * a - pair) / (2 * m[2]);
}

// The gradient of the shares of the 27 cells around, x fastest: central differences, means over the other two axes with weights 1, 2, 1.
Vec3 gradient(const std::array<double, 27>& share, const std::array<double, 3>& distance) {
  constexpr size_t kStep[] = {1, 3, 9};
  Vec3 out{};
  for (int d = 0; d < 3; ++d) {
    if (distance[static_cast<size_t>(d)] == 0) continue;
    const size_t along = kStep[d], p = kStep[(d + 1) % 3], q = kStep[(d + 2) % 3];
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j) {
        const size_t at = along + i * p + j * q;
        const double weight = (i == 1 ? 2.0 : 1.0) * (j == 1 ? 2.0 : 1.0);
        out[d] += weight / 16 * (share[at + along] - share[at - along]) / distance[static_cast<size_t>(d)];
      }
  }
  return out;
}

}  // namespace

double plane_constant(const Vec3& m, double share) {
  const double sum = m[0] + m[1] + m[2];
  Vec3 sorted;
  for (int d = 0; d < 3; ++d) sorted[d] = m[d] / sum < kFlat ? 0 : m[d] / sum;
  std::ranges::sort(sorted);
  const double left = sorted[0] + sorted[1] + sorted[2];
  for (double& x : sorted) x /= left;
  const double wanted = std::min(share, 1 - share);
  double low = 0, high = 0.5;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (volume_below(sorted, middle) < wanted ? low : high) = middle;
  }
  return (share <= 0.5 ? low : 1 - low) * sum;
}

std::optional<CutPlane> cut_plane(const FractionReader& fractions, const Grid& grid, const Index3& cell, uint32_t material) {
  // Beyond the grid the cells at its sides go on.
  const Index3 n = grid.cells();
  Box around;
  std::array<double, 3> distance;
  for (int d = 0; d < 3; ++d) {
    around.lo[d] = std::max<int64_t>(cell[d] - 1, 0), around.hi[d] = std::min(cell[d] + 2, n[d]);
    distance[static_cast<size_t>(d)] = grid.axis[d].centre(around.hi[d] - 1) - grid.axis[d].centre(around.lo[d]);
  }
  std::array<double, 27> found, share;
  fractions.read_box(around, material, 0.0, found.data(), {1, 3, 9});
  const auto place = [&](int64_t x, int64_t y, int64_t z) {
    const Index3 at{cell[0] + x, cell[1] + y, cell[2] + z};
    int64_t out = 0;
    for (int d = 2; d >= 0; --d) out = 3 * out + std::clamp(at[d], around.lo[d], around.hi[d] - 1) - around.lo[d];
    return static_cast<size_t>(out);
  };
  size_t next = 0;
  for (int64_t z = -1; z <= 1; ++z)
    for (int64_t y = -1; y <= 1; ++y)
      for (int64_t x = -1; x <= 1; ++x) share[next++] = found[place(x, y, z)];
  const double own = share[13];
  Vec3 normal = gradient(share, distance);
  const double length = norm(normal);
  if (!(own > 0 && own < 1) || length == 0) return {};
  CutPlane out{{}, 0};
  Vec3 across;
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = grid.axis[d];
    const double size = axis.plane(cell[d] + 1) - axis.plane(cell[d]);
    out.normal[d] = 0 - normal[d] / length;  // no negative zero
    across[d] = std::abs(out.normal[d]) * size;
    out.offset += out.normal[d] * (out.normal[d] < 0 ? axis.plane(cell[d] + 1) : axis.plane(cell[d]));  // where the plane's constant is 0
  }
  out.offset += plane_constant(across, own);
  return out;
}

}  // namespace teracell::store
