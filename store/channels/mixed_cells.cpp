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
  stretches.clear(), longer.clear(), shares.clear(), counts.clear();
  sets.clear();
  runs = 0;
}

void MixedCells::name_set(uint32_t more_runs, uint32_t set, size_t first) {
  if (set > 0 && shares.empty()) {
    shares.resize(runs);
    for (uint32_t run = 0; run < runs; ++run) shares[run] = {0, run * static_cast<uint32_t>(sets[0].size())};
  }
  if (set > 0 || !shares.empty())
    for (uint32_t i = 0; i < more_runs; ++i) shares.push_back({set, static_cast<uint32_t>(first + i * sets[set].size())});
  runs += more_runs;
}

void MixedCells::add(uint32_t from, uint32_t to, std::span<const uint32_t> labels, std::span<const uint32_t> of_labels) {
  const Shares latest = runs > 0 ? shares_of(runs - 1) : Shares{};
  const bool again = runs > 0 && same(sets[latest.set], labels), goes_on = stretches.size() > begin.back() && end_ == from;
  end_ = to;
  if (again && goes_on && same({counts.data() + latest.first, labels.size()}, of_labels)) return lengthen(runs - 1, to - from);
  if (!goes_on) stretches.push_back({from, runs});
  if (to - from > 1) longer.push_back({runs, to - from});
  const size_t first = counts.size();
  counts.resize(first + of_labels.size());
  for (size_t i = 0; i < of_labels.size(); ++i) counts[first + i] = of_labels[i];
  name_set(1, again ? latest.set : sets.intern(labels), first);
}

void MixedCells::add_ray(const MixedCells& other, uint32_t ray) {
  const size_t begin_of = other.begin[ray], end_of = other.begin[ray + 1];
  if (begin_of == end_of) return;
  const uint32_t first = other.first_run(begin_of), last = other.first_run(end_of), before = runs;
  for (size_t s = begin_of; s < end_of; ++s) stretches.push_back({other.stretches[s].from, other.stretches[s].first_run - first + before});
  for (auto l = std::ranges::lower_bound(other.longer, first, {}, &Longer::run); l != other.longer.end() && l->run < last; ++l)
    longer.push_back({l->run - first + before, l->cells});
  end_ = stretches.back().from + (before + last - first) - stretches.back().first_run;
  for (auto l = longer.rbegin(); l != longer.rend() && l->run >= stretches.back().first_run; ++l) end_ += l->cells - 1;
  const size_t counts_before = counts.size(), from = other.shares_of(first).first;
  const size_t to = last < other.runs ? other.shares_of(last).first : other.counts.size();
  counts.insert(counts.end(), other.counts.begin() + static_cast<ptrdiff_t>(from), other.counts.begin() + static_cast<ptrdiff_t>(to));
  if (other.shares.empty()) return name_set(last - first, sets.intern(other.sets[0]), counts_before);
  for (uint32_t run = first; run < last; ++run)
    name_set(1, sets.intern(other.sets[other.shares[run].set]), counts_before + other.shares[run].first - from);
}

MixedCells::RunsOfRay::Iterator::Iterator(const MixedCells& cells, uint32_t stretch)
    : cells_(&cells), stretch_(stretch), run_(cells.first_run(stretch)) {
  if (run_ == cells.runs) return;
  from_ = cells.stretches[stretch].from;
  longer_ = static_cast<size_t>(std::ranges::lower_bound(cells.longer, run_, {}, &Longer::run) - cells.longer.begin());
  take_cells();
}

void MixedCells::RunsOfRay::Iterator::take_cells() {
  const bool is_longer = longer_ < cells_->longer.size() && cells_->longer[longer_].run == run_;
  to_ = from_ + (is_longer ? cells_->longer[longer_++].cells : 1);
}

MixedCells::RunsOfRay::Iterator& MixedCells::RunsOfRay::Iterator::operator++() {
  if (++run_ == cells_->runs) return *this;
  from_ = run_ == cells_->first_run(stretch_ + size_t{1}) ? cells_->stretches[++stretch_].from : to_;
  take_cells();
  return *this;
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
