#include "store/format/chunk_stats.hpp"

#include <algorithm>

#include "store/grid/set_memo.hpp"

namespace teracell::inline store {

// Rays of equal pattern are summed change by change before labels are looked at.
std::vector<LabelStats> stats_of(const RayBlock& b) {
  SetMemo<LabelStats> counted;
  const auto add = [&](Label label, uint64_t cells, std::array<uint32_t, 3> lo, std::array<uint32_t, 3> hi) {
    LabelStats& stats = counted.get(label, [&] { return LabelStats{label, 0, lo, hi}; });
    stats.cells += cells;
    for (int d = 0; d < 3; ++d) {
      stats.lo[d] = std::min(stats.lo[d], lo[d]);
      stats.hi[d] = std::max(stats.hi[d], hi[d]);
    }
  };
  for (uint32_t v = 0; v < b.nv; ++v) {
    for (uint32_t u = 0; u < b.nu;) {  // a stretch of one pattern
      const uint32_t first = v * b.nu + u, pattern = b.pattern[first], n = b.patterns.changes(pattern);
      uint32_t end = u + 1;
      while (end < b.nu && b.pattern[v * b.nu + end] == pattern) ++end;
      const auto sets = b.patterns.sets(pattern);
      const uint32_t *at = b.at.data() + b.begin[first], *stop = at + size_t{n} * (end - u);
      uint64_t from_sum = 0;
      uint32_t from_least = 0;
      for (uint32_t i = 0; i < n; ++i) {
        uint64_t sum = 0;
        uint32_t least = ~0u, most = 0;
        for (const uint32_t* x = at + i; x < stop; x += n) {
          sum += *x;
          least = std::min(least, *x);
          most = std::max(most, *x);
        }
        add(sets[i], sum - from_sum, {u, v, from_least}, {end, v + 1, most});
        from_sum = sum;
        from_least = least;
      }
      add(sets[n], uint64_t{b.length} * (end - u) - from_sum, {u, v, from_least}, {end, v + 1, b.length});
      u = end;
    }
  }
  std::vector<LabelStats> all = counted.values();
  std::ranges::sort(all, {}, &LabelStats::label);
  return all;
}

}  // namespace teracell::store
