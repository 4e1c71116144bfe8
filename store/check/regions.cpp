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
  std::vector<uint32_t> numbers(nodes.size());
  for (uint32_t node = 0; node < nodes.size(); ++node) {
    const uint32_t first = groups.of(node);  // it comes first
    if (first == node) {
      numbers[node] = static_cast<uint32_t>(out.all.size());
      out.all.push_back(nodes[node]);
    } else {
      numbers[node] = numbers[first];
      out.all[numbers[first]].add(nodes[node]);
    }
  }
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
        for_touching(run, u, v, others, [&](const RegionRun& other) {
          const uint32_t a = groups_.of(run.region), b = groups_.of(other.region);
          if (a == b) return;
          groups_.join(a, b);
          nodes_[std::min(a, b)].add(nodes_[std::max(a, b)]);
        });
}

void RegionJoiner::add(uint32_t cu, BlockRegions&& block) {
  const auto base = static_cast<uint32_t>(nodes_.size());
  for (const Component& c : block.all) {
    groups_.add();
    nodes_.push_back(c);
  }
  for (RegionRun& run : block.border) run.region += base;
  join(block.border, before_);
  join(block.border, corner_);
  join(block.border, above_[cu]);
  if (cu + 1 < above_.size()) join(block.border, above_[cu + 1]);
  corner_ = std::move(above_[cu]);
  above_[cu] = block.border;
  before_ = std::move(block.border);
  if (cu + 1 == above_.size()) retire();
}

// What the last row of blocks does not reach is finished. The rest is numbered anew.
void RegionJoiner::retire() {
  before_.clear(), corner_.clear();
  std::vector<uint32_t> numbers(nodes_.size(), ~uint32_t{0});
  std::vector<Component> left;
  for (std::vector<RegionRun>& border : above_)
    for (RegionRun& run : border) {
      const uint32_t node = groups_.of(run.region);
      if (numbers[node] == ~uint32_t{0}) {
        numbers[node] = static_cast<uint32_t>(left.size());
        left.push_back(nodes_[node]);
      }
      run.region = numbers[node];
    }
  for (uint32_t node = 0; node < nodes_.size(); ++node)
    if (groups_.stands_for_one(node) && numbers[node] == ~uint32_t{0}) finished_(nodes_[node]);
  nodes_ = std::move(left);
  groups_ = Groups(nodes_.size());
}

void RegionJoiner::finish() {
  for (const Component& c : nodes_) finished_(c);
  nodes_.clear(), groups_ = Groups();
}

}  // namespace teracell::store
