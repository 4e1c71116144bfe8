#include "mesher/boundary/sub_axis.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::mesher {

Axis sub_axis(const Axis& axis, uint32_t samples, int64_t from, int64_t to) {
  if (!axis.is_graded()) return Axis::uniform(axis.origin(), axis.step() / samples, (axis.first() + from) * samples, (to - from) * samples, 0.5);
  const std::vector<double>& p = axis.planes();
  std::vector<double> planes;
  planes.reserve(static_cast<size_t>(to - from) * samples + 1);
  for (int64_t i = from; i < to; ++i)
    for (uint32_t k = 0; k < samples; ++k) planes.push_back(p[i] + (static_cast<double>(k) / samples) * (p[i + 1] - p[i]));
  planes.push_back(p[to]);
  return Axis::graded(std::move(planes), 0.5);
}

// A uniform axis is checked as a whole where it has few enough cells, and else at its end, where doubles are farthest apart.
void check_sub_samples(const Grid& grid, const std::array<uint32_t, 3>& samples) {
  constexpr int64_t kAtOnce = 1 << 14;
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = grid.axis[d];
    try {
      for (int64_t from = 0; from < axis.cells(); from += kAtOnce) {
        const int64_t to = std::min(axis.cells(), from + kAtOnce);
        sub_axis(axis, samples[d], from, to);
        if (!axis.is_graded() && to < axis.cells()) from = std::max(from, axis.cells() - 2 * kAtOnce);
      }
    } catch (const UsageError& e) {
      throw UsageError(fmt::format("{} sub-samples per cell along {}: {}", samples[d], axis_name(d), e.what()));
    }
  }
}

}  // namespace teracell::mesher
