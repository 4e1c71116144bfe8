#include "mesher/boundary/fractions.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "mesher/boundary/sub_axis.hpp"

namespace teracell::mesher {
namespace {

// A block has one ray, or up to so many sub-rays along u and along v: one of 256 x 256 no longer fits into the caches, and took 5 % longer.
// Along the rays it has so many sub-samples: on a graded axis they take memory, and everywhere they are counted in 32 bits.
constexpr int64_t kSubRaysU = 256, kSubRaysV = 32, kGradedSamples = 1 << 20, kUniformSamples = 1 << 29;
// Where many surfaces lie above each other, blocks have fewer rays, whose sub-rays cross them about so many times.
constexpr uint64_t kBlockCrossings = uint64_t{1} << 22;

// Calls f(from, to) for pieces of [lo, hi) of a length.
template <class F>
void in_pieces(int64_t lo, int64_t hi, int64_t length, F&& f) {
  for (int64_t from = lo; from < hi; from += length) f(from, std::min(from + length, hi));
}

// Appends cells of a ray, in order, whose sub-samples all have one label: those are mixed that have another label themselves.
class OneLabel {
 public:
  // `ends` and `sets` are the runs that the ray has in the grid.
  OneLabel(std::span<const uint32_t> ends, std::span<const SetId> sets, uint32_t total) : ends_(ends), sets_(sets), total_(total) {}
  void add(uint32_t from, uint32_t to, Label label, MixedCells& out) {
    while (run_ < ends_.size() && ends_[run_] <= from) ++run_;
    for (; from < to; ++run_) {
      const uint32_t end = run_ < ends_.size() ? std::min(ends_[run_], to) : to;
      if (sets_[run_] != label) out.add(from, end, {&label, 1}, {&total_, 1});
      from = end;
      if (end == to) return;
    }
  }

 private:
  const std::span<const uint32_t> ends_;
  const std::span<const SetId> sets_;
  const uint32_t total_;
  size_t run_ = 0;
};

// Sorts by insertion. That is fast for few numbers that are nearly in order.
void insertion_sort(std::span<uint32_t> numbers) {
  for (size_t i = 1; i < numbers.size(); ++i) {
    const uint32_t number = numbers[i];
    size_t j = i;
    for (; j > 0 && numbers[j - 1] > number; --j) numbers[j] = numbers[j - 1];
    numbers[j] = number;
  }
}

std::vector<Label> labels_of(const std::vector<Layer>& layers, const Labels& labels) {
  std::vector<Label> out;
  for (const Layer& layer : layers) out.push_back(labels.of_body[layer.body]);
  return out;
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
      sub_tile_{frame_, {}, {}, &axis_},
      simple_(frame_, samples, labels_of(layers, labels)) {}

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
    size_t blocks = 0;
    in_pieces(tile.lo[u], tile.hi[u], rays_u, [&](int64_t u0, int64_t u1) {
      in_pieces(tile.lo[w], tile.hi[w], length, [&](int64_t w0, int64_t w1) {
        cells.lo[u] = u0, cells.hi[u] = u1, cells.lo[w] = w0, cells.hi[w] = w1;
        if (blocks_.size() == blocks) blocks_.emplace_back();
        MixedCells& block = blocks_[blocks++];
        block.reset(static_cast<uint32_t>(u1 - u0), static_cast<uint32_t>(v1 - v0), runs.length, total_);
        count_block(tile, cells, facets, engine, runs, block);
      });
    });
    for (uint32_t j = 0; j < v1 - v0; ++j)
      for (size_t first = 0; first < blocks; first += stretches)
        for (uint32_t i = 0; i < blocks_[first].nu; ++i) {
          const uint32_t ray = j * blocks_[first].nu + i;
          out.add_ray(blocks_[first], ray);
          for (const MixedCells& block : std::span(blocks_).subspan(first + 1, stretches - 1))
            for (const MixedCells::Run& run : block.of_ray(ray)) out.add(run.from, run.to, block.labels(run), block.counts_of(run));
          out.end_ray();
        }
  });
}

void FractionCounter::count_block(const Box& tile, const Box& cells, std::span<const SceneFacet* const> facets, Engine& engine, const RayBlock& runs,
                                  MixedCells& out) {
  const auto [u, v, w] = frame_;
  const auto nu = static_cast<uint32_t>(cells.hi[u] - cells.lo[u]), nv = static_cast<uint32_t>(cells.hi[v] - cells.lo[v]);
  cast(cells, facets, engine);
  for (uint32_t j = 0; j < nv; ++j) {
    const auto first = static_cast<uint32_t>((cells.lo[v] - tile.lo[v] + j) * runs.nu + (cells.lo[u] - tile.lo[u]));
    if (cells.lo[w] == 0 && in_planes_) simple_.find({runs, first, nu, planes_, j, sub_tile_.u.size(), static_cast<int32_t>(axis_.cells())});
    else simple_.find_none(nu);
    compose_others(j, nu, cells);
    for (uint32_t i = 0, other = 0; i < nu;) {
      if (simple_.has(i)) {
        i = simple_.add(i, out);
      } else {
        const auto ends = runs.changes(first + i), sets = runs.sets(first + i);
        if (!count_two_labels(other, cells, ends, sets, out) && !count_plain_ray(other, cells, ends, sets, out)) {
          find_changes(other);
          count_ray(cells, ends, sets, out);
        }
        out.end_ray();
        ++i, ++other;
      }
    }
  }
}

// Casts the block's sub-rays.
void FractionCounter::cast(const Box& cells, std::span<const SceneFacet* const> facets, Engine& engine) {
  const auto [u, v, w] = frame_;
  const auto axis_of = [&](int d) { return sub_axis(meta_.grid.axis[d], samples_[d], cells.lo[d], cells.hi[d]); };
  if (axis_cells_ != std::pair(cells.lo[w], cells.hi[w])) axis_ = axis_of(w), axis_cells_ = {cells.lo[w], cells.hi[w]};
  fill(sub_tile_.u, axis_of(u));
  fill(sub_tile_.v, axis_of(v));
  near_.clear();
  for (const SceneFacet* facet : facets) {
    const auto& [a, b, c] = facet->facet.vertex;
    const auto meets = [&](int d, const std::vector<double>& rays) {
      return std::max(std::max(a[d], b[d]), c[d]) >= rays.front() && std::min(std::min(a[d], b[d]), c[d]) <= rays.back();
    };
    if (meets(u, sub_tile_.u) && meets(v, sub_tile_.v)) near_.push_back(facet);
  }
  in_planes_ = near_.empty() && !engine.searches_scene();
  if (in_planes_) return planes_.reset(sub_tile_.rays(), 0);
  try {
    in_planes_ = engine.cast_planes(sub_tile_, near_, planes_);
    if (!in_planes_) engine.cast(sub_tile_, near_, crossings_);
  } catch (const InputError& e) {
    throw InputError(fmt::format("fractions of {} x {} x {} sub-samples per cell: {}", samples_[0], samples_[1], samples_[2], e.what()));
  }
}

// Makes the runs of the sub-rays of those rays of the row v that are not simple.
void FractionCounter::compose_others(uint32_t v, uint32_t nu, const Box& cells) {
  const uint32_t su = samples_[frame_.u], sv = samples_[frame_.v];
  others_.clear();
  for (uint32_t i = 0; i < nu; ++i)
    if (!simple_.has(i)) others_.push_back(i);
  if (others_.empty()) return;
  Crossings& c = other_crossings_;
  c.begin.assign(1, 0);
  c.all.clear();
  for (uint32_t j = 0; j < sv; ++j)
    for (const uint32_t i : others_)
      for (uint32_t k = 0; k < su; ++k) {
        const size_t ray = (size_t{v} * sv + j) * sub_tile_.u.size() + size_t{i} * su + k;
        if (in_planes_) planes_.append(ray, c.all);
        else c.all.insert(c.all.end(), crossings_.all.begin() + crossings_.begin[ray], crossings_.all.begin() + crossings_.begin[ray + 1]);
        c.begin.push_back(static_cast<uint32_t>(c.all.size()));
      }
  composer_.compose(c, static_cast<uint32_t>(others_.size()) * su, sv, static_cast<uint32_t>(axis_.cells()), sub_runs_);
  // What the composer counts is of no use here.
  composer_.take_overlaps(cells);
  composer_.take_cells();
}

// Counts a ray whose sub-rays all have the labels that it has itself, and in which no cell has two of their changes. Nearly all rays are like
// that, and take a tenth of the time that sorting all changes would. Returns false if this is another one.
bool FractionCounter::count_plain_ray(uint32_t u, const Box& cells, std::span<const uint32_t> ends, std::span<const SetId> sets, MixedCells& out) {
  const uint32_t su = samples_[frame_.u], sv = samples_[frame_.v], per_ray = samples_[frame_.w], rays = su * sv;
  const auto shift = static_cast<uint32_t>(std::countr_zero(per_ray));
  const uint32_t corner = u * su, pattern = sub_runs_.pattern[corner];
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
    if (ends[n] < from || ends[n] > to || to - from > SimpleRays::kMostCells || (n > 0 && from < stretches_.back().to)) return false;
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

// Counts a ray whose sub-rays have one label and the background. Returns false if this is another one.
bool FractionCounter::count_two_labels(uint32_t u, const Box& cells, std::span<const uint32_t> ends, std::span<const SetId> sets, MixedCells& out) {
  const uint32_t su = samples_[frame_.u], sv = samples_[frame_.v], per_ray = samples_[frame_.w];
  const auto shift = static_cast<uint32_t>(std::countr_zero(per_ray));
  Label label = 0;
  uint32_t inside = 0;  // how many sub-rays are
  std::vector<uint32_t>& changes = plain_;  // the sub-sample, and whether the sub-ray enters there
  changes.clear();
  size_t all = 0, most = 0;  // changes of all sub-rays, and of the one that has most of them
  for (uint32_t j = 0; j < sv; ++j)
    for (uint32_t i = 0; i < su; ++i) {
      const auto of_ray = sub_runs_.sets(j * sub_runs_.nu + u * su + i);
      for (const Label l : of_ray) {
        if (l != 0 && label == 0) label = l;
        if (l != 0 && l != label) return false;
      }
      inside += of_ray[0] != 0;
      all += of_ray.size() - 1, most = std::max(most, of_ray.size() - 1);
    }
  // Adds the changes [first, last) of each sub-ray.
  const auto add_changes = [&](size_t first, size_t last) {
    for (uint32_t j = 0; j < sv; ++j)
      for (uint32_t i = 0; i < su; ++i) {
        const uint32_t ray = j * sub_runs_.nu + u * su + i;
        const auto at = sub_runs_.changes(ray);
        const auto of_ray = sub_runs_.sets(ray);
        for (size_t n = first; n < std::min(last, at.size()); ++n) changes.push_back(at[n] << 1 | (of_ray[n + 1] != 0));
      }
  };
  if (constexpr size_t kMostInserted = 256; all <= kMostInserted) {
    for (size_t n = 0; n < most; ++n) add_changes(n, n + 1);  // nearly in their order
    insertion_sort(changes);
  } else {
    add_changes(0, most);
    std::ranges::sort(changes);
  }

  OneLabel one_label(ends, sets, total_);
  const uint32_t labels[2] = {0, label};
  const auto add = [&](uint32_t from, uint32_t to, uint32_t samples) {  // of the label
    if (samples == 0 || samples == total_) return one_label.add(from, to, samples == 0 ? 0 : label, out);
    const uint32_t counts[2] = {total_ - samples, samples};
    out.add(from, to, labels, counts);
  };
  auto cell = static_cast<uint32_t>(cells.lo[frame_.w]);
  const auto first = cell, end = static_cast<uint32_t>(cells.hi[frame_.w]);
  for (auto change = changes.begin(); cell < end;) {
    const uint32_t next = change == changes.end() ? end : first + (*change >> 1 >> shift);
    if (cell < next) add(cell, next, inside * per_ray), cell = next;
    if (cell == end) return true;
    uint32_t samples = inside * per_ray;
    for (; change != changes.end() && first + (*change >> 1 >> shift) == cell; ++change) {
      const uint32_t left = per_ray - (*change >> 1 & (per_ray - 1));
      if (*change & 1) samples += left, ++inside;
      else samples -= left, --inside;
    }
    add(cell, cell + 1, samples), ++cell;
  }
  return true;
}

// Of the sub-rays of the ray u of the others: their changes in order, and their labels in its first cell.
void FractionCounter::find_changes(uint32_t u) {
  const uint32_t su = samples_[frame_.u], sv = samples_[frame_.v];
  changes_.clear();
  shares_.clear();
  for (uint32_t j = 0; j < sv; ++j)
    for (uint32_t i = 0; i < su; ++i) {
      const uint32_t ray = j * sub_runs_.nu + u * su + i;
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
  OneLabel one_label(ends, sets, total_);
  // The cells [from, to) have the shares.
  const auto add = [&](uint32_t from, uint32_t to) {
    std::erase_if(shares_, [](const Share& s) { return s.sub_samples == 0; });
    if (shares_.size() == 1) return one_label.add(from, to, shares_[0].label, out);
    std::ranges::sort(shares_, {}, &Share::label);
    labels_.clear(), counts_.clear();
    for (const Share& s : shares_) labels_.push_back(s.label), counts_.push_back(static_cast<uint32_t>(s.sub_samples));
    out.add(from, to, labels_, counts_);
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
