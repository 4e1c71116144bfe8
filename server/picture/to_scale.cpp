#include "server/picture/to_scale.hpp"

#include <algorithm>

namespace teracell::server {
namespace {

double plane(const Axis& axis, int level, int64_t i) { return axis.plane(std::min(axis.cells(), i << level)); }

}  // namespace

double length_of(const Axis& axis, int level, int64_t from, int64_t to) { return plane(axis, level, to) - plane(axis, level, from); }

std::vector<int64_t> cells_to_scale(const Axis& axis, int level, int64_t from, int64_t to, int64_t pixels) {
  const double begin = plane(axis, level, from), length = length_of(axis, level, from, to);
  std::vector<int64_t> out;
  for (int64_t i = 0; i < pixels; ++i) {
    const double middle = begin + (static_cast<double>(i) + 0.5) / static_cast<double>(pixels) * length;
    out.push_back(std::clamp(axis.cell_at(std::clamp(middle, axis.min(), axis.max())) >> level, from, to - 1));
  }
  return out;
}

}  // namespace teracell::server
