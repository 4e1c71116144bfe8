// Which parts of a partition can meet: those whose boxes' stretches of one axis do.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

namespace teracell::inline store {

// The axis along which the parts begin at most places: slabs differ along one alone.
template <class Part>
int sweep_axis(const std::vector<Part>& parts) {
  std::array<std::ptrdiff_t, 3> places;
  std::vector<int64_t> lo(parts.size());
  for (int d = 0; d < 3; ++d) {
    std::ranges::transform(parts, lo.begin(), [&](const Part& part) { return part.box.lo[d]; });
    std::ranges::sort(lo);
    places[static_cast<size_t>(d)] = std::unique(lo.begin(), lo.end()) - lo.begin();
  }
  return static_cast<int>(std::ranges::max_element(places) - places.begin());
}

// Sweeps along this axis. Calls near(i, j) once for each two parts whose stretches, one of them longer by `reach` cells, overlap.
template <class Part, class Near>
void for_each_near_pair(const std::vector<Part>& parts, int64_t reach, Near&& near) {
  const int axis = sweep_axis(parts);
  const auto lo = [&](size_t i) { return parts[i].box.lo[axis]; };
  std::vector<size_t> order(parts.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::sort(order, {}, lo);
  for (size_t i = 0; i < order.size(); ++i)
    for (size_t j = i + 1; j < order.size() && lo(order[j]) < parts[order[i]].box.hi[axis] + reach; ++j) near(order[i], order[j]);
}

}  // namespace teracell::store
