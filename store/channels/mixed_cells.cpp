#include "store/channels/mixed_cells.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

namespace teracell::inline store {

std::string beyond_bounds(const Subdivision& s) {
  uint64_t product = 1;
  for (const uint32_t n : s) {
    if (n < 1 || n > 256 || !std::has_single_bit(n)) return fmt::format("sub-samples along an axis are a power of two from 1 to 256, found {}", n);
    product *= n;
  }
  return product <= 65536 ? "" : fmt::format("a cell has at most 65536 sub-samples, found {} x {} x {} = {}", s[0], s[1], s[2], product);
}

void MixedCells::reset(uint32_t new_nu, uint32_t new_nv, uint32_t new_length, uint32_t new_total) {
  nu = new_nu, nv = new_nv, length = new_length, total = new_total;
  begin.assign(1, 0);
  runs.clear();
  sets.clear();
  counts.clear();
}

void MixedCells::add(uint32_t from, uint32_t to, std::span<const uint32_t> labels, std::span<const uint32_t> of_labels) {
  if (runs.size() > begin.back()) {
    Run& last = runs.back();
    if (last.to == from && same(sets[last.set], labels) && same(counts_of(last), of_labels)) {
      last.to = to;
      return;
    }
  }
  const bool again = !runs.empty() && same(sets[runs.back().set], labels);
  runs.push_back({from, to, again ? runs.back().set : sets.intern(labels), static_cast<uint32_t>(counts.size())});
  counts.insert(counts.end(), of_labels.begin(), of_labels.end());
}

MixedCells cut(const MixedCells& cells, uint32_t from, uint32_t to) {
  MixedCells out;
  out.reset(cells.nu, cells.nv, to - from, cells.total);
  for (uint32_t ray = 0; ray < cells.nu * cells.nv; ++ray) {
    for (const MixedCells::Run& run : cells.of_ray(ray))
      if (run.to > from && run.from < to)
        out.add(std::max(run.from, from) - from, std::min(run.to, to) - from, cells.labels(run), cells.counts_of(run));
    out.end_ray();
  }
  return out;
}

}  // namespace teracell::store
