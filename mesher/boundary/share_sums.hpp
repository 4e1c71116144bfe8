// How many sub-samples labels have in mixed cells, beyond those of the mixed cells that are theirs: with the cells of a label, its volume.
#pragma once
#include <algorithm>
#include <cstdint>
#include <map>

#include "store/channels/mixed_cells.hpp"
#include "store/runs/run.hpp"

namespace teracell::mesher {

using ShareSums = std::map<uint32_t, int64_t>;  // by label; what is 0 may be missing

// `runs` are those of the same rays.
inline void add_shares(const MixedCells& mixed, const RayBlock& runs, ShareSums& sums) {
  for (uint32_t ray = 0; ray + 1 < mixed.begin.size(); ++ray) {
    const auto of_ray = mixed.of_ray(ray);
    if (of_ray.empty()) continue;
    for (const MixedCells::Run& m : of_ray) {
      const auto labels = mixed.labels(m);
      const auto counts = mixed.counts_of(m);
      for (size_t i = 0; i < labels.size(); ++i) sums[labels[i]] += int64_t{counts[i]} * (m.to - m.from);
    }
    auto next = of_ray.begin();
    runs.for_each_run(ray, [&](uint32_t from, uint32_t to, SetId label) {
      while (next != of_ray.end() && (*next).to <= from) ++next;
      for (auto i = next; i != of_ray.end() && (*i).from < to; ++i)
        sums[label] -= int64_t{mixed.total} * (std::min((*i).to, to) - std::max((*i).from, from));
    });
  }
}

}  // namespace teracell::mesher
