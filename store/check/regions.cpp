#include "store/check/regions.hpp"

#include <algorithm>

namespace teracell::inline store {
namespace {

// Calls f(other) for the runs of the same label on a ray that touch a run.
template <class F>
void for_touching(const RegionRun& run, uint32_t u, uint32_t v, std::span<const RegionRun> others, F&& f) {
  const auto place = [](const RegionRun& r) { return std::tuple(r.v, r.u, r.to); };
  for (auto other = std::ranges::lower_bound(others, std::tuple(v, u, run.from), {}, place);
       other != others.end() && other->u == u && other->v == v && other->from <= run.to; ++other)
    if (other->label == run.label) f(*other);
}

}  // namespace

BlockRegions regions_of(std::span<const ThinRun> runs, const RayWindow& block, const RayFrame& frame) {
  Groups groups;
  std::vector<RegionRun> all;
  std::vector<Component> nodes;
  for (const ThinRun& run : runs) {
    const auto node = static_cast<uint32_t>(nodes.size());
    const Index3 first = frame.cell(run.u, run.v, run.from);
    nodes.push_back({run.label,
                     run.halves,
                     run.to - run.from,
                     {run.u, run.v, run.from},
                     {run.u + 1, run.v + 1, run.to},
                     {static_cast<uint32_t>(first[2]), static_cast<uint32_t>(first[1]), static_cast<uint32_t>(first[0])}});
    groups.add();
    const RegionRun mine{run.u, run.v, run.from, run.to, node, run.label};
    const auto join = [&](const RegionRun& other) { groups.join(other.region, node); };
    for (uint32_t u = run.u - (run.u > block.u0); u <= run.u + 1; ++u)
      if (run.v > block.v0) for_touching(mine, u, run.v - 1, all, join);
    if (run.u > block.u0) for_touching(mine, run.u - 1, run.v, all, join);
    for_touching(mine, run.u, run.v, all, join);
    all.push_back(mine);
  }
  BlockRegions out;
  const std::vector<uint32_t> numbers = join_parts(groups, nodes, out.all);
  for (RegionRun& run : all) {
    if (run.u > block.u0 && run.v > block.v0 && run.u + 1 < block.u1 && run.v + 1 < block.v1) continue;
    run.region = numbers[run.region];
    out.border.push_back(run);
  }
  return out;
}

void RegionJoiner::join(std::span<const RegionRun> runs, std::span<const RegionRun> others) {
  if (others.empty()) return;
  for (const RegionRun& run : runs)
    for (uint32_t v = run.v - (run.v > 0); v <= run.v + 1; ++v)
      for (uint32_t u = run.u - (run.u > 0); u <= run.u + 1; ++u)
        for_touching(run, u, v, others, [&](const RegionRun& other) { open_.join(run.region, other.region); });
}

void RegionJoiner::add(uint32_t cu, BlockRegions&& block) {
  const uint32_t base = open_.add(block.all);
  for (RegionRun& run : block.border) run.region += base;
  join(block.border, before_);
  join(block.border, corner_);
  join(block.border, above_[cu]);
  if (cu + 1 < above_.size()) join(block.border, above_[cu + 1]);
  corner_ = std::move(above_[cu]);
  above_[cu] = block.border;
  before_ = std::move(block.border);
  if (cu + 1 < above_.size()) return;
  before_.clear(), corner_.clear();
  for (std::vector<RegionRun>& border : above_)
    for (RegionRun& run : border) run.region = open_.keep(run.region);
  open_.finish_others();
}

}  // namespace teracell::store
