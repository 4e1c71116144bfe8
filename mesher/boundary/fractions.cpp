#include "mesher/boundary/fractions.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "mesher/boundary/sub_axis.hpp"

namespace teracell::mesher {
namespace {

// A block has one ray, or up to so many sub-rays along u and along v: one of 256 x 256 no longer fits into the caches, and took 5 % longer.
// Along the rays it has so many sub-samples: on a graded axis they take memory, and everywhere they are counted in 32 bits.
constexpr int64_t kSubRaysU = 256, kSubRaysV = 64, kGradedSamples = 1 << 20, kUniformSamples = 1 << 30;
// Where many surfaces lie above each other, blocks have fewer rays, whose sub-rays cross them about so many times.
constexpr uint64_t kBlockCrossings = uint64_t{1} << 22;

// How many cells a change of a plain ray may be spread over.
constexpr uint32_t kMostPlainCells = 64;

// Calls f(from, to) for pieces of [lo, hi) of a length.
template <class F>
void in_pieces(int64_t lo, int64_t hi, int64_t length, F&& f) {
  for (int64_t from = lo; from < hi; from += length) f(from, std::min(from + length, hi));
}

void fill(std::vector<double>& out, const Axis& axis) {
  out.clear();
  for (int64_t i = 0; i < axis.cells(); ++i) out.push_back(axis.centre(i));
}

}  // namespace

FractionCounter::FractionCounter(const std::vector<Layer>& layers, const Labels& labels, const Metadata& meta, const Subdivision& samples)
    : meta_(meta),
      frame_(meta.frame()),
      samples_(samples),
      total_(sub_samples(samples)),
      composer_(layers, labels.rank, labels.of_body, labels.of_overlap, meta.ray_axis),
      sub_tile_{frame_, {}, {}, &axis_} {}

void FractionCounter::count(const Cells& all, std::span<const SceneFacet* const> facets, Engine& engine, MixedCells& out) {
  const Box& tile = all.box;
  const RayBlock& runs = *all.runs;
  const auto [u, v, w] = frame_;
  const auto sub_rays = static_cast<int64_t>(kBlockCrossings / (all.crossings / runs.rays() + 1));
  const int64_t rays_u = std::max<int64_t>(std::min(kSubRaysU, sub_rays) / samples_[u], 1);
  const int64_t rays_v = std::max<int64_t>(std::min(kSubRaysV, sub_rays / kSubRaysU) / samples_[v], 1);
  const int64_t length = std::max<int64_t>((meta_.grid.axis[w].is_graded() ? kGradedSamples : kUniformSamples) / samples_[w], 1);
  const auto stretches = static_cast<size_t>((tile.hi[w] + length - 1) / length);
  out.reset(runs.nu, runs.nv, runs.length, total_);
  in_pieces(tile.lo[v], tile.hi[v], rays_v, [&](int64_t v0, int64_t v1) {
    Box cells = tile;
    cells.lo[v] = v0, cells.hi[v] = v1;
    if (stretches == 1 && tile.hi[u] - tile.lo[u] <= rays_u) return count_block(tile, cells, facets, engine, runs, out);
    blocks_.clear();
    in_pieces(tile.lo[u], tile.hi[u], rays_u, [&](int64_t u0, int64_t u1) {
      in_pieces(tile.lo[w], tile.hi[w], length, [&](int64_t w0, int64_t w1) {
        cells.lo[u] = u0, cells.hi[u] = u1, cells.lo[w] = w0, cells.hi[w] = w1;
        blocks_.emplace_back().reset(static_cast<uint32_t>(u1 - u0), static_cast<uint32_t>(v1 - v0), runs.length, total_);
        count_block(tile, cells, facets, engine, runs, blocks_.back());
      });
    });
    for (uint32_t j = 0; j < v1 - v0; ++j)
      for (size_t first = 0; first < blocks_.size(); first += stretches)
        for (uint32_t i = 0; i < blocks_[first].nu; ++i) {
          for (const MixedCells& block : std::span(blocks_).subspan(first, stretches))
            for (const MixedCells::Run& run : block.of_ray(j * block.nu + i)) out.add(run.from, run.to, block.labels(run), block.counts_of(run));
          out.end_ray();
        }
  });
}

void FractionCounter::count_block(const Box& tile, const Box& cells, std::span<const SceneFacet* const> facets, Engine& engine, const RayBlock& runs,
                                  MixedCells& out) {
  const auto [u, v, w] = frame_;
  const auto nu = static_cast<uint32_t>(cells.hi[u] - cells.lo[u]), nv = static_cast<uint32_t>(cells.hi[v] - cells.lo[v]);
  cast(cells, facets, engine);
  for (uint32_t j = 0; j < nv; ++j)
    for (uint32_t i = 0; i < nu; ++i) {
      const auto ray = static_cast<uint32_t>((cells.lo[v] - tile.lo[v] + j) * runs.nu + (cells.lo[u] - tile.lo[u] + i));
      if (!count_plain_ray(i, j, cells, runs.changes(ray), runs.sets(ray), out)) {
        find_changes(i, j);
        count_ray(cells, runs.changes(ray), runs.sets(ray), out);
      }
      out.end_ray();
    }
}

// Makes the runs of the block's sub-rays.
void FractionCounter::cast(const Box& cells, std::span<const SceneFacet* const> facets, Engine& engine) {
  const auto [u, v, w] = frame_;
  const auto axis_of = [&](int d) { return sub_axis(meta_.grid.axis[d], samples_[d], cells.lo[d], cells.hi[d]); };
  if (axis_cells_ != std::pair(cells.lo[w], cells.hi[w])) axis_ = axis_of(w), axis_cells_ = {cells.lo[w], cells.hi[w]};
  fill(sub_tile_.u, axis_of(u));
  fill(sub_tile_.v, axis_of(v));
  const auto nu = static_cast<uint32_t>(sub_tile_.u.size()), nv = static_cast<uint32_t>(sub_tile_.v.size());
  const auto length = static_cast<uint32_t>(axis_.cells());
  near_.clear();
  for (const SceneFacet* facet : facets) {
    const auto& [a, b, c] = facet->facet.vertex;
    const auto meets = [&](int d, const std::vector<double>& rays) {
      return std::max(std::max(a[d], b[d]), c[d]) >= rays.front() && std::min(std::min(a[d], b[d]), c[d]) <= rays.back();
    };
    if (meets(u, sub_tile_.u) && meets(v, sub_tile_.v)) near_.push_back(facet);
  }
  if (near_.empty() && !engine.searches_scene()) return sub_runs_.fill(nu, nv, length, 0);
  try {
    engine.cast(sub_tile_, near_, crossings_);
  } catch (const InputError& e) {
    throw InputError(fmt::format("fractions of {} x {} x {} sub-samples per cell: {}", samples_[0], samples_[1], samples_[2], e.what()));
  }
  composer_.compose(crossings_, nu, nv, length, sub_runs_);
  // What the composer counts is of no use here.
  composer_.take_overlaps(cells);
  composer_.take_cells();
}

// Counts a ray whose sub-rays all have the labels that it has itself, and in which no cell has two of their changes. Nearly all rays are like
// that, and take a tenth of the time that sorting all changes would. Returns false if this is another one.
bool FractionCounter::count_plain_ray(uint32_t u, uint32_t v, const Box& cells, std::span<const uint32_t> ends, std::span<const SetId> sets,
                                      MixedCells& out) {
  const uint32_t su = samples_[frame_.u], sv = samples_[frame_.v], per_ray = samples_[frame_.w], rays = su * sv;
  const auto shift = static_cast<uint32_t>(std::countr_zero(per_ray));
  const uint32_t corner = v * sv * sub_runs_.nu + u * su, pattern = sub_runs_.pattern[corner];
  if (cells.lo[frame_.w] != 0 || !same(sub_runs_.patterns.sets(pattern), sets)) return false;
  uint32_t different = 0;
  for (uint32_t j = 0; j < sv; ++j)
    for (uint32_t i = 0; i < su; ++i) different |= sub_runs_.pattern[corner + j * sub_runs_.nu + i] ^ pattern;
  if (different != 0) return false;

  // Change n lies in the cells [from, to). Places of one change stand together in plain_. The sub-rays of a row have equally many changes each,
  // one sub-ray after another, so what they have in sub_runs_ stands together, too.
  const auto count = static_cast<uint32_t>(ends.size());
  plain_.resize(size_t{count} * rays);
  stretches_.clear();
  for (uint32_t n = 0; n < count; ++n) {
    uint32_t* const at = plain_.data() + size_t{n} * rays;
    uint32_t first = ~uint32_t{0}, last = 0;
    for (uint32_t j = 0; j < sv; ++j) {
      const uint32_t* const row = sub_runs_.at.data() + sub_runs_.begin[corner + j * sub_runs_.nu] + n;
      for (uint32_t i = 0; i < su; ++i) {
        const uint32_t place = row[size_t{i} * count];
        at[j * su + i] = place;
        first = std::min(first, place), last = std::max(last, place);
      }
    }
    const uint32_t from = first >> shift, to = (last + per_ray - 1) >> shift;
    if (ends[n] < from || ends[n] > to || to - from > kMostPlainCells || (n > 0 && from < stretches_.back().to)) return false;
    stretches_.push_back({from, to});
  }
  for (uint32_t n = 0; n < count; ++n) {
    const uint32_t* const at = plain_.data() + size_t{n} * rays;
    const bool up = sets[n] < sets[n + 1];
    const uint32_t labels[2] = {up ? sets[n] : sets[n + 1], up ? sets[n + 1] : sets[n]};
    for (uint32_t cell = stretches_[n].from; cell < stretches_[n].to; ++cell) {
      // Of each sub-ray what lies behind its change. Adding up in memory cell by cell would wait for what was just stored.
      const auto end = static_cast<int32_t>((cell + 1) << shift), most = static_cast<int32_t>(per_ray);
      int32_t behind = 0;
      for (uint32_t r = 0; r < rays; ++r) behind += std::clamp(end - static_cast<int32_t>(at[r]), 0, most);
      const auto next = static_cast<uint32_t>(behind);
      const uint32_t counts[2] = {up ? total_ - next : next, up ? next : total_ - next};
      out.add(cell, cell + 1, labels, counts);
    }
  }
  return true;
}

// Of the sub-rays of the ray (u, v) of the block: their changes in order, and their labels in its first cell.
void FractionCounter::find_changes(uint32_t u, uint32_t v) {
  const uint32_t su = samples_[frame_.u], sv = samples_[frame_.v];
  changes_.clear();
  shares_.clear();
  for (uint32_t j = 0; j < sv; ++j)
    for (uint32_t i = 0; i < su; ++i) {
      const uint32_t ray = (v * sv + j) * sub_runs_.nu + u * su + i;
      const auto at = sub_runs_.changes(ray);
      const auto sets = sub_runs_.sets(ray);
      give(sets[0], samples_[frame_.w]);
      for (size_t n = 0; n < at.size(); ++n) changes_.push_back({at[n], sets[n], sets[n + 1]});
    }
  std::ranges::sort(changes_, {}, &Change::at);
}

void FractionCounter::give(Label label, int64_t sub_samples) {
  for (Share& share : shares_)
    if (share.label == label) {
      share.sub_samples += sub_samples;
      return;
    }
  shares_.push_back({label, sub_samples});
}

// `ends` and `sets` are the runs that the ray has in the grid.
void FractionCounter::count_ray(const Box& cells, std::span<const uint32_t> ends, std::span<const SetId> sets, MixedCells& out) {
  const int w = frame_.w;
  const uint32_t per_ray = samples_[w], shift = static_cast<uint32_t>(std::countr_zero(per_ray));
  size_t run = 0;  // of the grid
  // The cells [from, to) have the shares.
  const auto add = [&](uint32_t from, uint32_t to) {
    std::erase_if(shares_, [](const Share& s) { return s.sub_samples == 0; });
    if (shares_.size() > 1) {
      std::ranges::sort(shares_, {}, &Share::label);
      labels_.clear(), counts_.clear();
      for (const Share& s : shares_) labels_.push_back(s.label), counts_.push_back(static_cast<uint32_t>(s.sub_samples));
      return out.add(from, to, labels_, counts_);
    }
    const Label label = shares_[0].label;
    while (run < ends.size() && ends[run] <= from) ++run;
    for (; from < to; ++run) {
      const uint32_t end = run < ends.size() ? std::min(ends[run], to) : to;
      if (sets[run] != label) out.add(from, end, {&label, 1}, {&total_, 1});
      from = end;
      if (end == to) return;
    }
  };
  auto cell = static_cast<uint32_t>(cells.lo[w]);
  const auto first = cell, end = static_cast<uint32_t>(cells.hi[w]);
  for (auto change = changes_.begin(); cell < end;) {
    const uint32_t next = change == changes_.end() ? end : first + (change->at >> shift);
    if (cell < next) add(cell, next), cell = next;
    if (cell == end) return;
    // In this cell the new label has what is left of it, and from the next cell on all of it.
    const auto begin = change;
    for (; change != changes_.end() && first + (change->at >> shift) == cell; ++change) {
      const uint32_t left = per_ray - (change->at & (per_ray - 1));
      give(change->from, -int64_t{left}), give(change->to, left);
    }
    add(cell, cell + 1), ++cell;
    for (auto c = begin; c != change; ++c) {
      const uint32_t before = c->at & (per_ray - 1);
      give(c->from, -int64_t{before}), give(c->to, before);
    }
  }
}

}  // namespace teracell::mesher
