#include "mesher/thin/thin.hpp"

#include <algorithm>

#include "mesher/closing/closing.hpp"

namespace teracell::mesher {
namespace {

// The most intervals of a block: so few that their bits stay in a core's cache.
constexpr int64_t kBlockIntervals = int64_t{1} << 20;

}  // namespace

ThinParts::ThinParts(const Scene& scene, const Labels& labels, const Grid& grid, int ray_axis, bool count_all)
    : scene_(scene),
      labels_(labels),
      grid_(grid),
      rays_(RayFrame::along(ray_axis)),
      count_all_(count_all),
      lines_{FacetLines{grid, 0, grid.axis[0]}, FacetLines{grid, 1, grid.axis[1]}, FacetLines{grid, 2, grid.axis[2]}} {}

void ThinParts::find(const Box& tile, std::span<const SceneFacet* const> facets, const Crossings& crossings, Marks& marks, Tallies& tallies) {
  tile_ = tile;
  crossings_ = &crossings, marks_ = &marks, tallies_ = &tallies;
  const int64_t rays = (tile.hi[rays_.u] - tile.lo[rays_.u]) * (tile.hi[rays_.v] - tile.lo[rays_.v]);
  blocks_.for_each(
      grid_, tile, rays_.w, facets, std::max<int64_t>(kBlockIntervals / rays, 1), false,
      [&](const SceneFacet& facet) { return wanted(scene_.bodies[body_of_layer(facet.layer)], count_all_); },
      [&](const Box& cells, std::span<const SceneFacet* const> of_block) {
        active_ = of_block;
        for (int axis = 0; axis < 3; ++axis) find_along(axis, cells);
      });
}

// An interval has the number of its upper cell, the first one whose sample point is above a facet there.
void ThinParts::find_along(int axis, const Box& cells) {
  Box intervals = cells;
  intervals.lo[axis] = std::max<int64_t>(intervals.lo[axis], 1);
  if (axis != rays_.w) intervals.hi[axis] = std::min(intervals.hi[axis] + 1, grid_.axis[axis].cells());
  if (intervals.empty()) return;
  const Index3 n = {intervals.hi[0] - intervals.lo[0], intervals.hi[1] - intervals.lo[1], intervals.hi[2] - intervals.lo[2]};
  const Index3 stride = {1, n[0], n[0] * n[1]};
  const auto words = static_cast<size_t>((n[0] * n[1] * n[2] + 63) / 64);
  once_.assign(words, 0), twice_.assign(words, 0);
  crossers_.clear();
  const int along = lines_[axis].frame().u;
  for (uint32_t f = 0; f < active_.size(); ++f)
    lines_[axis].cross_exactly(active_[f]->facet, cells, exact_decisions_,
                               [&](Index3 cell, std::span<const uint32_t> above, std::span<const uint32_t> subs, bool up) {
                                 cell[axis] = intervals.lo[axis];
                                 auto line = static_cast<uint32_t>((cell[0] - intervals.lo[0]) * stride[0] + (cell[1] - intervals.lo[1]) * stride[1] +
                                                                   (cell[2] - intervals.lo[2]) * stride[2]);
                                 for (size_t i = 0; i < above.size(); ++i) {
                                   const uint32_t upper = above[i];
                                   if (upper >= intervals.lo[axis] && upper < intervals.hi[axis]) {
                                     const uint32_t interval = line + static_cast<uint32_t>((upper - intervals.lo[axis]) * stride[axis]);
                                     const uint64_t bit = uint64_t{1} << (interval % 64);
                                     twice_[interval / 64] |= once_[interval / 64] & bit;
                                     once_[interval / 64] |= bit;
                                     crossers_.push_back({interval, f, subs[i], up});
                                   }
                                   line += static_cast<uint32_t>(stride[along]);
                                 }
                               });
  std::erase_if(crossers_, [&](const Crosser& c) { return (twice_[c.interval / 64] >> (c.interval % 64) & 1) == 0; });
  std::ranges::sort(crossers_);
  for (size_t i = 0; i < crossers_.size();) {
    const size_t first = i;
    const int64_t interval = crossers_[i].interval;
    while (i < crossers_.size() && crossers_[i].interval == interval) ++i;
    look_at(axis, {intervals.lo[0] + interval % n[0], intervals.lo[1] + interval / n[0] % n[1], intervals.lo[2] + interval / stride[2]},
            {crossers_.data() + first, i - first});
  }
}

void ThinParts::look_at(int axis, const Index3& upper, std::span<const Crosser> crossers) {
  bodies_.clear();  // the bodies with at least two of the facets
  for (size_t i = 0; i < crossers.size(); ++i) {
    const uint32_t body = body_of_layer(active_[crossers[i].facet]->layer);
    const auto is_same = [&](const Crosser& c) { return body_of_layer(active_[c.facet]->layer) == body; };
    if (std::ranges::count_if(crossers.first(i), is_same) == 1) bodies_.push_back(body);
  }
  if (bodies_.empty() && !count_all_) return;

  Index3 lower = upper;
  --lower[axis];
  const bool owns_lower = lower[axis] >= tile_.lo[axis];
  sum_crossings(owns_lower ? lower : upper);
  lower_ = upper_ = sums_;
  for (const Crosser& c : crossers) {
    const int step = step_along(axis, c.up, rays_.w);
    const uint32_t layer = active_[c.facet]->layer;
    owns_lower ? upper_.add(layer, step) : lower_.add(layer, -step);
  }
  std::erase_if(bodies_, [&](uint32_t body) { return lower_.inside(body) || upper_.inside(body); });
  const uint32_t around = count_all_ ? material(lower_) : 0;
  const bool may_have_gap = around != 0 && around == material(upper_);
  if (bodies_.empty() && !may_have_gap) return;

  steps_.clear();
  for (const Crosser& c : crossers) steps_.push_back({c.k, active_[c.facet]->layer, step_along(axis, c.up, rays_.w)});
  std::ranges::sort(steps_, {}, &Step::k);
  const auto tally = [&](TallyKey::What what, uint32_t of, const Stretches& s) {
    if (!owns_lower || s.widest == 0) return;
    tallies_->add({what, of, static_cast<uint8_t>(axis)}, {1, length_of(grid_.axis[axis], lower[axis], s.widest), s.widest, s.from, lower});
  };
  for (const uint32_t body : bodies_) {
    const Stretches lost = stretches([&] { return sums_.inside(body); });
    tally(TallyKey::What::kStretches, body, lost);
    if (lost.widest > 0 && scene_.bodies[body].thin == Thin::kKeep) keep(axis, lower, lost.first, body);
  }
  if (may_have_gap) tally(TallyKey::What::kGaps, around, stretches([&] { return material(sums_) == 0; }));
}

uint32_t ThinParts::ray_of(const Index3& cell) const {
  return static_cast<uint32_t>((cell[rays_.v] - tile_.lo[rays_.v]) * (tile_.hi[rays_.u] - tile_.lo[rays_.u]) + cell[rays_.u] - tile_.lo[rays_.u]);
}

// Adds up the crossings below the sample point of a cell of the tile.
void ThinParts::sum_crossings(const Index3& cell) {
  sums_.clear();
  sums_.add_below(crossings_->of_ray(ray_of(cell)), static_cast<uint32_t>(cell[rays_.w]));
}

// The material of the strongest body that the point is inside of, or the background.
uint32_t ThinParts::material(const LayerSums& sums) const {
  const uint32_t owner = sums.owner(labels_.rank);
  return owner == kNoBody ? 0 : scene_.bodies[owner].material;
}

// The stretches of sub-positions whose sums make is() true. REQUIRES: it is false at both ends.
template <class Is>
ThinParts::Stretches ThinParts::stretches(Is&& is) {
  Stretches out;
  uint32_t since = 0;  // where the current stretch began; 0 if there is none
  sums_ = lower_;
  for (size_t i = 0; i < steps_.size();) {
    const uint32_t k = steps_[i].k;
    for (; i < steps_.size() && steps_[i].k == k; ++i) sums_.add(steps_[i].layer, steps_[i].step);
    const bool begins = k < kSubPositions && is();
    if (begins && since == 0) since = k;
    if (begins || since == 0) continue;
    if (out.first == 0) out.first = since;
    if (k - since > out.widest) out.from = since, out.widest = k - since;
    since = 0;
  }
  return out;
}

// Gives the body the cell whose planes hold sub-position k, if the cell is in the tile.
void ThinParts::keep(int axis, const Index3& lower, uint32_t k, uint32_t body) {
  Index3 cell = lower;
  const Axis& a = grid_.axis[axis];
  if (sub_position(a, lower[axis], k) >= a.plane(lower[axis] + 1)) ++cell[axis];
  if (cell[axis] < tile_.lo[axis] || cell[axis] >= tile_.hi[axis]) return;
  const auto w = static_cast<uint32_t>(cell[rays_.w]);
  marks_->add(ray_of(cell), layer_of(body, false), w, w + 1);
}

}  // namespace teracell::mesher
