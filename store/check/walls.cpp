#include "store/check/walls.hpp"

#include <algorithm>

namespace teracell::inline store {

const std::vector<ThinRun>& Walls::thin_runs(const Field& field, uint32_t u, uint32_t v) {
  const RayBlock& rays = field.rays;
  const uint32_t ray = v * rays.nu + u;
  found_.clear(), out_.clear();
  const std::span<const SetId> labels = rays.sets(ray);
  if (labels.size() == 1 && labels[0] == 0) return out_;
  rays.for_each_run(ray, [&](uint32_t from, uint32_t to, Label label) {
    if (label != 0 && to - from <= kThickest && from > 0 && to < rays.length) found_.push_back({from, to, label, to - from});
  });
  const Row rows[] = {{1, std::min(u, kThickest), std::min(rays.nu - 1 - u, kThickest)},
                      {static_cast<ptrdiff_t>(rays.nu), std::min(v, kThickest), std::min(rays.nv - 1 - v, kThickest)}};
  for (const Row& row : rows)
    if (may_be_thin(rays, ray, row)) along_row(rays, ray, row);
  combine();
  return out_;
}

// A quick look that is right about most rays: where all rays of a row have the same pattern, a cell can only be thin if the run is lost on both
// sides of it.
bool Walls::may_be_thin(const RayBlock& rays, uint32_t ray, const Row& row) const {
  const uint32_t pattern = rays.pattern[ray];
  const auto other = [&](uint32_t i, int sign) {
    return static_cast<size_t>(static_cast<ptrdiff_t>(ray) + sign * static_cast<ptrdiff_t>(i) * row.step);
  };
  for (uint32_t i = 1; i <= row.before; ++i)
    if (rays.pattern[other(i, -1)] != pattern) return true;
  for (uint32_t i = 1; i <= row.after; ++i)
    if (rays.pattern[other(i, 1)] != pattern) return true;
  const std::span<const uint32_t> changes = rays.changes(ray);
  const std::span<const SetId> labels = rays.sets(ray);
  // Of the change where a run begins: the largest on each side; of the one where it ends: the smallest.
  uint32_t from_before = 0, from_after = 0;
  for (size_t run = 0; run < labels.size(); ++run) {
    const uint32_t from = run == 0 ? 0 : changes[run - 1], to = run < changes.size() ? changes[run] : rays.length;
    uint32_t to_before = to, to_after = to, next_before = to, next_after = to;
    if (run < changes.size()) {
      for (uint32_t i = 1; i <= row.before; ++i) {
        const uint32_t at = rays.at[rays.begin[other(i, -1)] + run];
        to_before = std::min(to_before, at), next_before = std::max(next_before, at);
      }
      for (uint32_t i = 1; i <= row.after; ++i) {
        const uint32_t at = rays.at[rays.begin[other(i, 1)] + run];
        to_after = std::min(to_after, at), next_after = std::max(next_after, at);
      }
    }
    if (labels[run] != 0 &&
        (std::min(from_before, from_after) > from || std::max(to_before, to_after) < to || to_before < from_after || to_after < from_before))
      return true;
    from_before = next_before, from_after = next_after;
  }
  return false;
}

// Follows the cells of `from` over `count` rays, and calls lost(interval, rays that it was followed over) where the label ends.
template <class F>
void Walls::follow(const RayBlock& rays, uint32_t ray, ptrdiff_t step, uint32_t count, Label label, Interval from, Kept& kept, F&& lost) {
  kept.now.assign(1, from);
  for (uint32_t i = 0; i < count && !kept.now.empty(); ++i) {
    const auto other = static_cast<uint32_t>(static_cast<ptrdiff_t>(ray) + static_cast<ptrdiff_t>(i + 1) * step);
    kept.next.clear();
    for (const Interval& interval : kept.now)
      rays.for_each_run(other, interval.from, interval.to, [&](uint32_t lo, uint32_t hi, Label there) {
        if (there == label) kept.next.push_back({lo, hi});
        else lost(Interval{lo, hi}, i);
      });
    std::swap(kept.now, kept.next);
  }
}

// What goes on for kThickest rays is thick, and what reaches the side of the domain does not count.
void Walls::along_row(const RayBlock& rays, uint32_t ray, const Row& row) {
  rays.for_each_run(ray, [&](uint32_t from, uint32_t to, Label label) {
    if (label == 0) return;
    follow(rays, ray, -row.step, row.before, label, {from, to}, before_, [&](Interval interval, uint32_t before) {
      follow(rays, ray, row.step, row.after, label, interval, after_, [&](Interval part, uint32_t after) {
        if (const uint32_t cells = before + 1 + after; cells <= kThickest) found_.push_back({part.from, part.to, label, cells});
      });
    });
  });
}

// The least thickness of each cell, as disjoint runs.
void Walls::combine() {
  if (found_.size() < 2) {
    std::swap(out_, found_);
    return;
  }
  std::ranges::sort(found_, {}, &ThinRun::from);
  open_.clear();
  size_t next = 0;
  for (uint32_t at = found_[0].from;;) {
    std::erase_if(open_, [&](const ThinRun& run) { return run.to <= at; });
    if (open_.empty()) {
      if (next == found_.size()) return;
      at = found_[next].from;
    }
    for (; next < found_.size() && found_[next].from == at; ++next) open_.push_back(found_[next]);
    uint32_t to = next < found_.size() ? found_[next].from : ~uint32_t{0};
    for (const ThinRun& run : open_) to = std::min(to, run.to);
    const ThinRun& least = *std::ranges::min_element(open_, {}, &ThinRun::cells);
    if (!out_.empty() && out_.back().to == at && out_.back().label == least.label && out_.back().cells == least.cells) out_.back().to = to;
    else out_.push_back({at, to, least.label, least.cells});
    at = to;
  }
}

}  // namespace teracell::store
