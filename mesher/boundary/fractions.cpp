#include "mesher/boundary/fractions.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "mesher/boundary/sub_axis.hpp"
#include "store/base/system/vector_units.hpp"

namespace teracell::mesher {
namespace {

// A block has one ray, or up to so many sub-rays along u and along v: one of 256 x 256 no longer fits into the caches, and took 5 % longer.
// Along the rays it has so many sub-samples: on a graded axis they take memory, and everywhere they are counted in 32 bits.
constexpr int64_t kSubRaysU = 256, kSubRaysV = 32, kGradedSamples = 1 << 20, kUniformSamples = 1 << 30;
// Where many surfaces lie above each other, blocks have fewer rays, whose sub-rays cross them about so many times.
constexpr uint64_t kBlockCrossings = uint64_t{1} << 22;

// How many cells a change of a plain ray may be spread over.
constexpr uint32_t kMostPlainCells = 64;
// How many changes a simple ray may have: what is known of eight such rays takes 128 KiB.
constexpr uint32_t kMostSimpleChanges = 64;

// Numbers of eight rays at once. They are written out as vectors, since compilers leave most such loops as they are at -O2.
constexpr uint32_t kLanes = 8;
using Lanes [[gnu::vector_size(32)]] = int32_t;
using CrossingLanes [[gnu::vector_size(32)]] = uint64_t;

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
      sub_tile_{frame_, {}, {}, &axis_} {
  for (const Layer& layer : layers) label_of_layer_.push_back(labels.of_body[layer.body]);
}

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
  for (uint32_t j = 0; j < nv; ++j) {
    const auto first = static_cast<uint32_t>((cells.lo[v] - tile.lo[v] + j) * runs.nu + (cells.lo[u] - tile.lo[u]));
    simple_.assign(nu, 0);
    alike_.clear(), spans_.clear();
    behind_size_ = 0;
    if (cells.lo[w] == 0) find_simple(j, nu, runs, first);
    compose_others(j, cells);
    auto alike = alike_.begin();
    for (uint32_t i = 0, other = 0; i < nu;) {
      if (simple_[i]) {
        while (alike->end <= i) ++alike;
        const uint32_t begin = i;
        while (i < alike->end && simple_[i]) ++i;
        add_simple(*alike, begin, i, out);
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
  if (near_.empty() && !engine.searches_scene()) {
    crossings_.begin.assign(sub_tile_.rays() + size_t{1}, 0);
    return;
  }
  try {
    engine.cast(sub_tile_, near_, crossings_);
  } catch (const InputError& e) {
    throw InputError(fmt::format("fractions of {} x {} x {} sub-samples per cell: {}", samples_[0], samples_[1], samples_[2], e.what()));
  }
}

// Finds the rays of the row v whose cells can be counted from the crossings at once: nearly all of a scene with one body.
void FractionCounter::find_simple(uint32_t v, uint32_t nu, const RayBlock& runs, uint32_t first_ray) {
  for (uint32_t begin = 0; begin < nu;) {
    uint32_t end = begin + 1;
    while (end < nu && runs.pattern[first_ray + end] == runs.pattern[first_ray + begin]) ++end;
    begin = find_alike(v, begin, end, runs, first_ray);
  }
}

// Looks at rays from `begin` on, which have the same pattern up to `end`. Returns where the rays end that are decided.
uint32_t FractionCounter::find_alike(uint32_t v, uint32_t begin, uint32_t end, const RayBlock& runs, uint32_t first_ray) {
  const uint32_t su = samples_[frame_.u], sv = samples_[frame_.v];
  const auto row_size = static_cast<uint32_t>(sub_tile_.u.size());
  const auto sets = runs.sets(first_ray + begin);
  const auto changes = static_cast<uint32_t>(sets.size()) - 1;
  if (changes > kMostSimpleChanges) return end;
  const Label label = changes == 0 ? 0 : sets[1];
  for (uint32_t i = 0; i <= changes; ++i)
    if (changes % 2 != 0 || sets[i] != (i % 2 == 0 ? 0 : label)) return end;
  const uint32_t* const begins = crossings_.begin.data() + size_t{v} * sv * row_size + size_t{begin} * su;
  for (uint32_t j = 0; j < sv; ++j) {
    const uint32_t* const row = begins + size_t{j} * row_size;
    Lanes differences = {};
    uint32_t i = 0;
    for (; i + kLanes <= (end - begin) * su; i += kLanes) {
      Lanes from, to;
      __builtin_memcpy(&from, row + i, sizeof from);
      __builtin_memcpy(&to, row + i + 1, sizeof to);
      differences |= (to - from) ^ static_cast<int32_t>(changes);
    }
    bool same = true;
    for (uint32_t l = 0; l < kLanes; ++l) same &= differences[l] == 0;
    for (i = same ? i : 0; i < (end - begin) * su; ++i)
      if (row[i + 1] - row[i] != changes) end = begin + i / su;
  }
  if (end == begin) return begin + 1;
  const Alike rays{begin, end, changes, label, spans_.size()};
  if (changes > 0) {
    const uint64_t crossing = crossings_.all[*begins];
    if (Crossing::is_mark(crossing) || label_of_layer_[Crossing::layer(crossing)] != label) return end;
    count_alike(rays, begins, runs.at.data() + runs.begin[first_ray + begin]);
  } else {
    std::fill(simple_.begin() + begin, simple_.begin() + end, 1);
  }
  alike_.push_back(rays);
  return end;
}

// A ray is simple if its sub-rays change as it does itself, all by crossings of one layer, up and down by turns, and if no cell has two of its
// changes.
void FractionCounter::count_alike(const Alike& rays, const uint32_t* begins, const uint32_t* ends) {
  const uint32_t su = samples_[frame_.u], sv = samples_[frame_.v], size = rays.end - rays.begin, changes = rays.changes;
  const auto per_ray = static_cast<int32_t>(samples_[frame_.w]), length = static_cast<int32_t>(axis_.cells());
  const int shift = std::countr_zero(samples_[frame_.w]);
  const size_t row_size = sub_tile_.u.size(), blocks = (size + kLanes - 1) / kLanes, most_counts = size_t{changes} * kMostPlainCells * kLanes;
  spans_.resize(rays.spans + blocks * changes);
  places_.resize(size_t{su} * sv * kLanes);
  const uint64_t* const all = crossings_.all.data();
  int32_t* const places = places_.data();
  const uint64_t turns = static_cast<uint32_t>(all[*begins]);
  for (size_t block = 0; block < blocks; ++block) {
    Spans* const spans = spans_.data() + rays.spans + block * changes;
    const size_t counts_begin = behind_size_;
    if (behind_.size() < counts_begin + most_counts) behind_.resize(2 * (counts_begin + most_counts));
    int32_t* const behind = behind_.data() + counts_begin;
    uint8_t* const simple = simple_.data() + rays.begin + block * kLanes;
    const uint32_t first = static_cast<uint32_t>(block) * kLanes, width = std::min(kLanes, size - first);
    size_t used = 0;
    on_vector_unit([=, &used]() TERACELL_IN_LINE {
      // The crossings of a row lie side by side, and go up and down by turns.
      const CrossingLanes expected = {turns, turns ^ 1, turns, turns ^ 1};
      CrossingLanes different = {};
      for (uint32_t j = 0; j < sv; ++j) {
        const uint64_t* const c = all + begins[j * row_size] + size_t{first} * su * changes;
        const uint32_t words = width * su * changes;
        uint32_t i = 0;
        for (; i + 4 <= words; i += 4) {
          CrossingLanes x;
          __builtin_memcpy(&x, c + i, sizeof x);
          different |= x ^ expected;
        }
        for (; i < words; ++i) different[i % 4] |= c[i] ^ expected[i % 4];
      }
      if (static_cast<uint32_t>(different[0] | different[1] | different[2] | different[3]) != 0) return;

      uint32_t ray[kLanes];
      for (uint32_t l = 0; l < kLanes; ++l) ray[l] = std::min(first + l, size - 1);
      const Lanes zero = {}, all_of_one = zero + per_ray;
      Lanes before = zero, good = ~zero;
      size_t counts = 0;
      for (uint32_t n = 0; n < changes; ++n) {
        Lanes least = zero + INT32_MAX, greatest = zero;
        int32_t* at = places;
        for (uint32_t j = 0; j < sv; ++j) {
          const uint64_t* c = all + begins[j * row_size] + n;
          const size_t step = size_t{su} * changes;
          for (uint32_t i = 0; i < su; ++i, c += changes, at += kLanes) {
            const auto place = [&](uint32_t l) TERACELL_IN_LINE { return static_cast<int32_t>(Crossing::cell(c[ray[l] * step])); };
            const Lanes p = {place(0), place(1), place(2), place(3), place(4), place(5), place(6), place(7)};
            __builtin_memcpy(at, &p, sizeof p);
            least = p < least ? p : least, greatest = p > greatest ? p : greatest;
          }
        }
        const auto change = [&](uint32_t l) TERACELL_IN_LINE { return static_cast<int32_t>(ends[ray[l] * changes + n]); };
        const Lanes end = {change(0), change(1), change(2), change(3), change(4), change(5), change(6), change(7)};
        const Lanes from = least >> shift, to = (greatest + (per_ray - 1)) >> shift, cells = to - from;
        good &= (least > 0) & (greatest < length) & (end >= from) & (end <= to) & (cells <= static_cast<int32_t>(kMostPlainCells)) & (from >= before);
        before = to;
        __builtin_memcpy(spans[n].from, &from, sizeof from);
        __builtin_memcpy(spans[n].to, &to, sizeof to);
        spans[n].counts = counts_begin + counts;
        int32_t most = 0;
        for (uint32_t l = 0; l < kLanes; ++l) most = std::max(most, good[l] ? cells[l] : 0);
        Lanes cell_end = (from + 1) << shift;
        for (int32_t cell = 0; cell < most; ++cell, cell_end += per_ray, counts += kLanes) {
          // Of each sub-ray what lies behind its change.
          Lanes sum = zero;
          for (uint32_t s = 0; s < su * sv; ++s) {
            Lanes p;
            __builtin_memcpy(&p, places + size_t{s} * kLanes, sizeof p);
            p = cell_end - p;
            p = p < zero ? zero : p;
            sum += p > all_of_one ? all_of_one : p;
          }
          __builtin_memcpy(behind + counts, &sum, sizeof sum);
        }
      }
      for (uint32_t l = 0; l < width; ++l) simple[l] = good[l] != 0;
      used = counts;
    });
    behind_size_ += used;
  }
}

// Appends rays of a row that are simple.
void FractionCounter::add_simple(const Alike& rays, uint32_t begin, uint32_t end, MixedCells& out) const {
  const uint32_t labels[2] = {0, rays.label}, first = begin - rays.begin, last = end - rays.begin, changes = rays.changes;
  const auto spans_of = [&](uint32_t ray) { return spans_.data() + rays.spans + size_t{ray / kLanes} * changes; };
  size_t most = 0;
  for (uint32_t ray = first; ray < last; ++ray)
    for (uint32_t n = 0; n < changes; ++n) most += static_cast<uint32_t>(spans_of(ray)[n].to[ray % kLanes] - spans_of(ray)[n].from[ray % kLanes]);
  const size_t runs_before = out.runs.size(), counts_before = out.counts.size();
  const uint32_t set = most > 0 ? out.sets.intern(labels) : 0;
  out.runs.resize(runs_before + most);
  out.counts.resize(counts_before + 2 * most);
  MixedCells::Run* run = out.runs.data() + runs_before;
  uint32_t* count = out.counts.data() + counts_before;
  const uint32_t total = total_;
  for (uint32_t ray = first; ray < last; ++ray) {
    const Spans* const spans = spans_of(ray);
    const uint32_t lane = ray % kLanes;
    uint32_t latest = 0, latest_end = 0;  // of the latest run of the ray: its sub-samples of the background, and where it ends
    for (uint32_t n = 0; n < changes; ++n) {
      const int32_t* behind = behind_.data() + spans[n].counts + lane;
      const auto to = static_cast<uint32_t>(spans[n].to[lane]);
      for (auto cell = static_cast<uint32_t>(spans[n].from[lane]); cell < to; ++cell, behind += kLanes) {
        const auto next = static_cast<uint32_t>(*behind), background = n % 2 == 0 ? total - next : next;
        if (background == latest && cell == latest_end) {
          run[-1].to = latest_end = cell + 1;
          continue;
        }
        *run++ = {cell, cell + 1, set, static_cast<uint32_t>(count - out.counts.data())};
        *count++ = latest = background, *count++ = total - background;
        latest_end = cell + 1;
      }
    }
    out.begin.push_back(static_cast<uint32_t>(run - out.runs.data()));
  }
  out.runs.resize(static_cast<size_t>(run - out.runs.data()));
  out.counts.resize(static_cast<size_t>(count - out.counts.data()));
}

// Makes the runs of the sub-rays of those rays of the row v that are not simple.
void FractionCounter::compose_others(uint32_t v, const Box& cells) {
  const uint32_t su = samples_[frame_.u], sv = samples_[frame_.v];
  others_.clear();
  for (uint32_t i = 0; i < simple_.size(); ++i)
    if (!simple_[i]) others_.push_back(i);
  if (others_.empty()) return;
  Crossings& c = other_crossings_;
  c.begin.assign(1, 0);
  c.all.clear();
  for (uint32_t j = 0; j < sv; ++j) {
    const uint32_t* const begins = crossings_.begin.data() + (size_t{v} * sv + j) * sub_tile_.u.size();
    for (const uint32_t i : others_) {
      const uint32_t* const ray = begins + size_t{i} * su;
      const auto shift = static_cast<uint32_t>(c.all.size()) - ray[0];
      c.all.insert(c.all.end(), crossings_.all.begin() + ray[0], crossings_.all.begin() + ray[su]);
      for (uint32_t k = 1; k <= su; ++k) c.begin.push_back(ray[k] + shift);
    }
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
