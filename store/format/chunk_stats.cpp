#include "store/format/chunk_stats.hpp"

#include <algorithm>

#include "store/base/system/vector_units.hpp"
#include "store/grid/set_memo.hpp"

namespace teracell::inline store {

namespace {

// What a change has along a stretch of rays.
struct SummedChanges {
  std::vector<uint64_t> sum;
  std::vector<uint32_t> least, most;
};

// Of `rays` rays with n changes each, at `at`. The numbers of some rays are a row, to which the rows after it are added place by place, and so
// by vectors.
void sum_changes(const uint32_t* at, uint32_t n, uint32_t rays, SummedChanges& out) {
  constexpr size_t kRays = 16;
  const size_t size = size_t{n} * rays, row = std::min(size, kRays * n);
  out.sum.assign(at, at + row);
  out.least.assign(at, at + row);
  out.most.assign(at, at + row);
  on_vector_unit([&]() TERACELL_IN_LINE {
    uint64_t* __restrict const sum = out.sum.data();
    uint32_t* __restrict const least = out.least.data(), * __restrict const most = out.most.data();
    const auto add = [=](const uint32_t* x, size_t count) TERACELL_IN_LINE {
      for (size_t i = 0; i < count; ++i) {
        sum[i] += x[i];
        least[i] = std::min(least[i], x[i]);
        most[i] = std::max(most[i], x[i]);
      }
    };
    const size_t width = row, end = size;
    const uint32_t* const from = at;
    size_t first = width;
    for (; first + width <= end; first += width) add(from + first, width);
    if (first < end) add(from + first, end - first);
  });
  for (size_t first = n; first < row; first += n)
    for (size_t i = 0; i < n; ++i) {
      out.sum[i] += out.sum[first + i];
      out.least[i] = std::min(out.least[i], out.least[first + i]);
      out.most[i] = std::max(out.most[i], out.most[first + i]);
    }
}

}  // namespace

// Rays of equal pattern are summed change by change before labels are looked at.
std::vector<LabelStats> stats_of(const RayBlock& b) {
  SetMemo<LabelStats> counted;
  SummedChanges changes;
  const auto add = [&](Label label, uint64_t cells, std::array<uint32_t, 3> lo, std::array<uint32_t, 3> hi) {
    LabelStats& stats = counted.get(label, [&] { return LabelStats{label, 0, lo, hi}; });
    stats.cells += cells;
    for (int d = 0; d < 3; ++d) {
      stats.lo[d] = std::min(stats.lo[d], lo[d]);
      stats.hi[d] = std::max(stats.hi[d], hi[d]);
    }
  };
  for (uint32_t first = 0, stop; first < b.rays(); first = stop) {  // a stretch of one pattern: of a row, or whole rows
    const uint32_t pattern = b.pattern[first], n = b.patterns.changes(pattern), u = first % b.nu, v = first / b.nu;
    stop = first + 1;
    while (stop < b.rays() && b.pattern[stop] == pattern) ++stop;
    stop = u == 0 && stop - first >= b.nu ? stop - stop % b.nu : std::min(stop, first - u + b.nu);
    const uint32_t u_end = (stop - 1) % b.nu + 1, v_end = (stop - 1) / b.nu + 1;
    const auto sets = b.patterns.sets(pattern);
    if (n > 0) sum_changes(b.at.data() + b.begin[first], n, stop - first, changes);
    uint64_t from_sum = 0;
    uint32_t from_least = 0;
    for (uint32_t i = 0; i < n; ++i) {
      add(sets[i], changes.sum[i] - from_sum, {u, v, from_least}, {u_end, v_end, changes.most[i]});
      from_sum = changes.sum[i];
      from_least = changes.least[i];
    }
    add(sets[n], uint64_t{b.length} * (stop - first) - from_sum, {u, v, from_least}, {u_end, v_end, b.length});
  }
  std::vector<LabelStats> all = counted.values();
  std::ranges::sort(all, {}, &LabelStats::label);
  return all;
}

}  // namespace teracell::store
