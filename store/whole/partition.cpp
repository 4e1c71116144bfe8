// Coarse levels tell of large boxes with cells of one weight, and the index how many cells of each material a chunk has. So where a cut
// lies is found among chunks first, without decoding any that lie in the box as a whole; only the layer of chunks that the cut goes through
// is decoded and counted layer by layer. A chunk has whole rays, so cuts across the rays come first: then cuts along them share what was
// decoded.
#include "store/whole/partition.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <ranges>
#include <unordered_map>

#include <fmt/format.h>

#include "store/read/kept_chunks.hpp"
#include "store/runs/chunk_parts.hpp"
#include "store/whole/near_parts.hpp"

namespace teracell::inline store {
namespace {

// With these the JSON of a partition has less than the 1 GiB that the library reads.
constexpr int64_t kMostRanks = int64_t{1} << 21, kMostNeighbours = int64_t{1} << 26;  // the neighbours of all parts together

int64_t cells_in(const Box& b, int axis) { return b.hi[axis] - b.lo[axis]; }
// Of one layer of a box across an axis.
double layer_cells(const Box& b, int axis) {
  double out = 1;
  for (int d = 0; d < 3; ++d)
    if (d != axis) out *= static_cast<double>(cells_in(b, d));
  return out;
}

// The weight of layers of cells along an axis, by stretches of layers that weigh the same: as much memory as there are changes.
class Layers {
 public:
  // Each of the layers [from, to) weighs so much more.
  void add(int64_t from, int64_t to, double weight) { changes_[from] += weight, changes_[to] -= weight; }
  // To be called once, after all were added.
  void sum_up() {
    std::vector<std::pair<int64_t, double>> changes(changes_.begin(), changes_.end());
    changes_ = {};
    std::ranges::sort(changes, {}, [](const auto& change) { return change.first; });
    for (const auto& [at, change] : changes) {
      const Stretch before = stretches_.empty() ? Stretch{at, 0, 0} : stretches_.back();
      stretches_.push_back({at, std::max(0.0, before.weight + change), before.weight_below(at)});  // rounding may leave a difference below 0
    }
  }
  // The weight of all layers below this one.
  double below(int64_t at) const {
    const auto next = std::ranges::upper_bound(stretches_, at, {}, &Stretch::from);
    return next == stretches_.begin() ? 0 : std::prev(next)->weight_below(at);
  }

 private:
  struct Stretch {
    int64_t from;
    double weight, below;  // of each of its layers, and of all before it
    double weight_below(int64_t at) const { return below + weight * static_cast<double>(at - from); }
  };
  std::unordered_map<int64_t, double> changes_;
  std::vector<Stretch> stretches_;
};

// Of the places first, first + 1 .. last, the one that has a weight below it nearest to the target; of several the one nearest to `even`.
// `below` never descends.
int64_t place_near(int64_t first, int64_t last, double target, double even, const std::function<double(int64_t)>& below) {
  const auto first_where = [&](const std::function<bool(double)>& reached) {  // or the one after the last
    const auto places = std::views::iota(first, last + 1);
    return first + (std::ranges::partition_point(places, [&](int64_t at) { return !reached(below(at)); }) - places.begin());
  };
  const int64_t above = first_where([&](double weight) { return weight > target; });
  const double lower = above > first ? below(above - 1) : 0, upper = above <= last ? below(above) : 0;
  const bool take_lower = above > first && (above > last || target - lower <= upper - target);
  const bool take_upper = above <= last && (above == first || upper - target <= target - lower);
  const int64_t begin = take_lower ? first_where([&](double weight) { return weight >= lower; }) : above;
  const int64_t end = take_upper ? first_where([&](double weight) { return weight > upper; }) : above;
  return std::clamp(static_cast<int64_t>(std::ceil(even - 0.5)), begin, end - 1);
}

class Cutter {
 public:
  Cutter(const GridReader& reader, const PartitionOptions& o, const std::function<void(double)>& progress)
      : reader_(reader), o_(o), progress_(progress), shape_(reader.shape(0)), frame_(reader.meta().frame()) {
    for (const LabelInfo& label : reader.meta().labels) weight_.push_back(o.weights[label.material]);
  }

  double weight_of(const Box& box) {
    const std::vector<double> blocks = by_chunks(box, frame_.u);
    return std::accumulate(blocks.begin(), blocks.end(), 0.0);
  }

  // Cuts a box among `ranks`, the lower ranks below. `along` has the layers of cells along the rays, if they are known already.
  void bisect(const Box& box, double weight, int64_t ranks, std::shared_ptr<const Layers> along = nullptr) {
    progress_(static_cast<double>(parts.size()) / static_cast<double>(o_.ranks));
    if (ranks == 1) {
      parts.push_back({box, std::max(0.0, weight), {}, {}});  // a difference, which rounding may leave below 0
      return;
    }
    const int64_t below = ranks / 2;
    const double target = weight * static_cast<double>(below) / static_cast<double>(ranks);
    const std::array<int, 3> axes = axes_to_cut(box, ranks);
    // All further cuts are along the rays, too: one pass is enough for them.
    if (axes[0] == frame_.w && !along) along = std::make_shared<const Layers>(by_layers(box, frame_.w));
    std::optional<Cut> best;
    for (const int axis : axes) {
      if (axis == frame_.w && !along && best) continue;  // a pass through the whole box would cost more than it gains
      const std::optional<Cut> cut = cut_near(box, axis, weight, target, below, ranks, along.get());
      if (!cut || (best && cut->error >= best->error)) continue;
      best = cut;
      if (best->error <= kGoodEnough * weight / static_cast<double>(ranks)) break;
    }
    if (!best) return cut_by_places(box, weight, ranks);
    Box lower = box, upper = box;
    lower.hi[best->axis] = upper.lo[best->axis] = best->at;
    if (best->axis != frame_.w) along = nullptr;
    bisect(lower, best->below, below, along);
    bisect(upper, weight - best->below, ranks - below, along);
  }

  // Where there are hardly more places to cut at than ranks: in the middle, with ranks on both sides by the places that there are.
  void cut_by_places(const Box& box, double weight, int64_t ranks) {
    for (const int axis : axes_to_cut(box, ranks)) {
      const int64_t a = o_.align, at = (box.lo[axis] + box.hi[axis] + a) / 2 / a * a;
      if (at <= box.lo[axis] || at >= box.hi[axis]) continue;
      Box lower = box, upper = box;
      lower.hi[axis] = upper.lo[axis] = at;
      const double places_below = places(lower), places_above = places(upper);
      if (static_cast<double>(ranks) > places_below + places_above) break;
      const double share = static_cast<double>(ranks) * places_below / (places_below + places_above);
      const auto below = static_cast<int64_t>(std::clamp(std::round(share), std::max(1.0, static_cast<double>(ranks) - places_above),
                                                         std::min(static_cast<double>(ranks) - 1, places_below)));
      const double weight_below = weight_of(lower);
      bisect(lower, weight_below, below);
      return bisect(upper, weight - weight_below, ranks - below);
    }
    throw OptionError(fmt::format("ranks: expected at most as many as there are boxes, cut at multiples of {} cells, found {}", o_.align, o_.ranks));
  }

  void slabs(const Box& box, double weight, int axis) {
    const Layers layers = by_layers(box, axis);
    const int64_t a = o_.align, most_slabs = places(box.lo[axis], box.hi[axis]);
    if (o_.ranks > most_slabs)
      throw OptionError(fmt::format("ranks: expected at most {}, the slabs along {} that cuts at multiples of {} cells give, found {}", most_slabs,
                                    axis_name(axis), a, o_.ranks));
    Box slab = box;
    double before = 0;
    for (int64_t rank = 0; rank < o_.ranks; ++rank) {
      const int64_t left = o_.ranks - rank - 1;  // each slab that follows needs a place
      const double share = static_cast<double>(rank + 1) / static_cast<double>(o_.ranks), even = static_cast<double>(most_slabs) * share;
      slab.hi[axis] = box.hi[axis];
      if (left > 0)
        slab.hi[axis] =
            a * place_near(slab.lo[axis] / a + 1, most_slabs - left, weight * share, even, [&](int64_t at) { return layers.below(at * a); });
      const double sum = left > 0 ? layers.below(slab.hi[axis]) : weight;
      parts.push_back({slab, std::max(0.0, sum - before), {}, {}});
      before = sum, slab.lo[axis] = slab.hi[axis];
    }
    progress_(1);
  }

  std::vector<Part> parts;

 private:
  static constexpr double kGoodEnough = 0.01;  // of a rank's share
  struct Cut {
    int axis;
    int64_t at;
    double below, error;
  };

  // The axes of a box in the order in which they are tried. A box is cut along its longest axis, again and again. Of the cuts that
  // this takes, those across the rays come first.
  std::array<int, 3> axes_to_cut(const Box& box, int64_t ranks) const {
    std::array<double, 3> size;
    for (int d = 0; d < 3; ++d) size[d] = static_cast<double>(cells_in(box, d));
    const auto longest = [&] { return static_cast<int>(std::ranges::max_element(size) - size.begin()); };
    bool across = false;
    auto halves = size;
    for (int64_t r = ranks; r > 1; r = (r + 1) / 2) {
      const auto d = static_cast<int>(std::ranges::max_element(halves) - halves.begin());
      across = across || d != frame_.w;
      halves[d] /= 2;
    }
    std::array<int, 3> axes = {frame_.u, frame_.v, frame_.w};
    std::ranges::sort(axes, [&](int a, int b) { return size[a] > size[b]; });
    if (across && longest() == frame_.w) std::swap(axes[0], axes[1]);
    return axes;
  }

  // The cut that leaves `target` of the weight below it, or as nearly as can be, and enough cells for the ranks on both sides.
  std::optional<Cut> cut_near(const Box& box, int axis, double weight, double target, int64_t below, int64_t ranks, const Layers* along) {
    const int64_t lo = box.lo[axis], hi = box.hi[axis], a = o_.align;
    int64_t others = 1;  // places to cut at along the other axes
    for (int d = 0; d < 3; ++d)
      if (d != axis) others = std::min<int64_t>(others * places(box.lo[d], box.hi[d]), ranks);
    const auto ceil_div = [](int64_t n, int64_t by) { return (n + by - 1) / by; };
    const int64_t first = (lo / a + ceil_div(below, others)) * a, last = (ceil_div(hi, a) - ceil_div(ranks - below, others)) * a;
    if (first > last || first <= lo || last >= hi) return std::nullopt;
    if (!(weight > 0)) {  // nothing to balance: by cells
      const int64_t middle = std::clamp((lo + (hi - lo) * below / ranks) / a * a, first, last);
      return Cut{axis, middle, 0, 0};
    }
    Box part = box;  // where the cut is searched
    const double even = static_cast<double>(lo) + static_cast<double>(hi - lo) * static_cast<double>(below) / static_cast<double>(ranks);
    const auto cut = [&](const Layers& layers, double before) -> std::optional<Cut> {  // `before`: the weight of the box below the layers
      const auto sum = [&](int64_t at) { return before + layers.below(at * a); };
      const int64_t from = ceil_div(std::max(first, part.lo[axis]), a), to = std::min(last, part.hi[axis]) / a;
      if (from > to) return std::nullopt;
      const int64_t at = place_near(from, to, target, even / static_cast<double>(a), sum);
      return Cut{axis, at * a, sum(at), std::abs(sum(at) - target)};
    };
    if (axis == frame_.w && along) return cut(*along, -along->below(lo));
    const double before = narrow(part, axis, target, first, last);
    return cut(by_layers(part, axis), before);
  }

  // Narrows a box to the chunk in which the weight passes the target, and on to the next places to cut at. Returns the weight below it.
  double narrow(Box& box, int axis, double target, int64_t first, int64_t last) {
    const int64_t lo = box.lo[axis], hi = box.hi[axis], a = o_.align, side = axis == frame_.w ? shape_.chunk_cells : shape_.chunk_rays;
    const std::vector<double> chunks = by_chunks(box, axis);
    double sum = 0;
    int64_t chunk = 0;
    for (; chunk + 1 < static_cast<int64_t>(chunks.size()) && sum + chunks[static_cast<size_t>(chunk)] <= target; ++chunk)
      sum += chunks[static_cast<size_t>(chunk)];
    const int64_t from = std::max(lo, (lo / side + chunk) * side), to = std::min(hi, (lo / side + chunk + 1) * side);
    box.lo[axis] = std::clamp(std::min(from / a * a, last), lo, hi);
    box.hi[axis] = std::clamp(std::max((to + a - 1) / a * a, first), lo, hi);
    if (box.lo[axis] == from) return sum;
    Box before = box;
    before.hi[axis] = from;
    return sum - weight_of(before);
  }
  double places(const Box& box) const {
    double all = 1;
    for (int d = 0; d < 3; ++d) all *= static_cast<double>(places(box.lo[d], box.hi[d]));
    return all;
  }
  int64_t places(int64_t lo, int64_t hi) const { return std::max<int64_t>(1, (hi + o_.align - 1) / o_.align - lo / o_.align); }

  // The work of a cell of the chunk, if it is known to be the same for all.
  std::optional<double> one_weight(const ChunkEntry& entry) const {
    const auto of_all = [&](const auto& labels, const auto& label_of) -> std::optional<double> {
      const auto weight = [&](const auto& l) { return weight_[label_of(l)]; };
      if (labels.empty() || std::ranges::adjacent_find(labels, std::not_equal_to(), weight) != labels.end()) return std::nullopt;
      return weight(labels.front());
    };
    if (entry.size == 0) return of_all(entry.uniform, std::identity());
    return of_all(entry.stats, [](const LabelStats& l) { return l.label; });
  }

  // The box in pieces: boxes whose cells weigh the same, as coarse chunks tell of many at once, and parts of chunks of level 0.
  void for_each_piece(const Box& box, const std::function<void(const Box&, double)>& same, const std::function<void(const ChunkPart&)>& mixed) {
    descend(reader_.levels() - 1, box, same, mixed);
  }
  void descend(int level, const Box& box, const std::function<void(const Box&, double)>& same, const std::function<void(const ChunkPart&)>& mixed) {
    Box on_level = box;
    for (int d = 0; d < 3; ++d) on_level.lo[d] >>= level, on_level.hi[d] = ceil_shift(box.hi[d], level);
    for_each_part(reader_.shape(level), RayBox(on_level, frame_), [&](const ChunkPart& p) {
      Box piece = frame_.box({p.first_u + p.u0, p.first_v + p.v0, p.first_w + p.w0}, {p.first_u + p.u1, p.first_v + p.v1, p.first_w + p.w1});
      for (int d = 0; d < 3; ++d) piece.lo[d] = std::max(piece.lo[d] << level, box.lo[d]), piece.hi[d] = std::min(piece.hi[d] << level, box.hi[d]);
      std::optional<double> weight;
      if (level != 1 && reader_.stored(level))
        weight = one_weight(*reader_.entry(p.key));  // packed grids alone store level 1: all are summed up alike
      if (weight) same(piece, *weight);
      else if (level > 0) descend(level - 1, piece, same, mixed);
      else mixed(p);
    });
  }

  std::shared_ptr<const Chunk> chunk(const ChunkKey& key) {
    return kept_.get(key, [&] {
      auto made = std::make_shared<Chunk>();
      reader_.read(key, *made);
      return made;
    });
  }

  // The weight in each chunk of a box along an axis.
  std::vector<double> by_chunks(const Box& box, int axis) {
    const int64_t side = axis == frame_.w ? shape_.chunk_cells : shape_.chunk_rays, first = box.lo[axis] / side;
    std::vector<double> out(static_cast<size_t>((box.hi[axis] - 1) / side - first + 1));
    for_each_piece(
        box,
        [&](const Box& piece, double weight) {
          const double layer = weight * layer_cells(piece, axis);
          for (int64_t chunk = piece.lo[axis] / side; chunk * side < piece.hi[axis]; ++chunk)
            out[static_cast<size_t>(chunk - first)] +=
                layer * static_cast<double>(std::min(piece.hi[axis], (chunk + 1) * side) - std::max(piece.lo[axis], chunk * side));
        },
        [&](const ChunkPart& p) {
          const uint32_t place = axis == frame_.u ? p.key.cu : axis == frame_.v ? p.key.cv : p.key.segment;
          double& sum = out[static_cast<size_t>(place - first)];
          if (p.whole)
            for (const LabelStats& l : reader_.entry(p.key)->stats) sum += weight_[l.label] * static_cast<double>(l.cells);
          else
            for_each_part_run(chunk(p.key)->rays, p,
                              [&](uint32_t, uint32_t, uint32_t from, uint32_t to, SetId label) { sum += weight_[label] * (to - from); });
        });
    return out;
  }

  Layers by_layers(const Box& box, int axis) {
    Layers out;
    for_each_piece(
        box, [&](const Box& piece, double weight) { out.add(piece.lo[axis], piece.hi[axis], weight * layer_cells(piece, axis)); },
        [&](const ChunkPart& p) {
          for_each_part_run(chunk(p.key)->rays, p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, SetId label) {
            if (axis == frame_.w) return out.add(p.first_w + from, p.first_w + to, weight_[label]);
            const int64_t at = axis == frame_.u ? p.first_u + u : p.first_v + v;
            out.add(at, at + 1, weight_[label] * (to - from));
          });
        });
    out.sum_up();
    return out;
  }

  const GridReader& reader_;
  const PartitionOptions& o_;
  const std::function<void(double)>& progress_;
  const LevelShape shape_;
  const RayFrame frame_;
  std::vector<double> weight_;  // by label
  KeptChunks kept_{size_t{64} << 20};
};

Box grown(const Box& box, int64_t by, int axis) {
  Box out = box;
  out.lo[axis] -= by, out.hi[axis] += by;
  return out;
}

void find_neighbours(std::vector<Part>& parts, int64_t halo, const std::function<void(double)>& progress) {
  constexpr uint64_t kAtOnce = 1 << 16;  // between two calls of progress
  const auto touch = [&](const Box& a, const Box& b) {
    if (halo == 0) return std::ranges::any_of(std::array{0, 1, 2}, [&](int d) { return overlap(grown(a, 1, d), b); });
    return overlap(grown(grown(grown(a, halo, 0), halo, 1), halo, 2), b);
  };
  int64_t found = 0;
  uint64_t compared = 0;
  for_each_near_pair(parts, std::max<int64_t>(halo, 1), [&](size_t i, size_t j) {
    if (compared++ % kAtOnce == 0) progress(1);
    if (!touch(parts[i].box, parts[j].box)) return;
    parts[i].neighbours.push_back(static_cast<int64_t>(j));
    parts[j].neighbours.push_back(static_cast<int64_t>(i));
    found += 2;
    if (found > kMostNeighbours)
      throw OptionError(fmt::format("halo: expected one with which {} parts have at most {} neighbours together, found {}, with which they have more",
                                    parts.size(), kMostNeighbours, halo));
  });
  for (Part& p : parts) std::ranges::sort(p.neighbours);
}

}  // namespace

Box with_halo(const Box& box, int64_t halo, const Index3& cells) {
  Box out;
  for (int d = 0; d < 3; ++d) {
    out.lo[d] = std::max<int64_t>(0, box.lo[d] - halo);
    out.hi[d] = std::min(cells[d], box.hi[d] + halo);
  }
  return out;
}

Partition make_partition(const GridReader& reader, const PartitionOptions& options, const std::function<void(double)>& progress) {
  const Metadata& meta = reader.meta();
  const auto expect = [](const char* name, int64_t value, int64_t least, int64_t most) {
    if (value < least || value > most) throw OptionError(fmt::format("{}: expected {} to {}, found {}", name, least, most, value));
  };
  expect("ranks", options.ranks, 1, kMostRanks);
  expect("align", options.align, 1, Axis::kMaxCells);
  expect("halo", options.halo, 0, Axis::kMaxCells);
  if (options.weights.size() != meta.materials.size())
    throw OptionError(fmt::format("weight: expected one for each of {} materials, found {}", meta.materials.size(), options.weights.size()));
  for (const double w : options.weights)
    if (!(w >= 0 && w < 1e30)) throw OptionError(fmt::format("weight: expected numbers from 0 to below 1e30, found {}", w));
  Partition out{options, {}, meta.grid.cells(), reader.hash(), 0, {}};
  for (const MaterialInfo& m : meta.materials) out.materials.push_back(m.name);
  const Box all = meta.grid.box(0);
  Cutter cutter(reader, options, progress);
  progress(0);
  out.total = cutter.weight_of(all);
  if (!(out.total > 0)) throw OptionError("weight: expected work in some cell of the grid, found 0 in all of them");
  if (options.method == PartitionMethod::kBlocks) cutter.bisect(all, out.total, options.ranks);
  else cutter.slabs(all, out.total, static_cast<int>(std::ranges::max_element(out.cells) - out.cells.begin()));
  out.parts = std::move(cutter.parts);
  for (Part& part : out.parts) part.halo_box = with_halo(part.box, options.halo, out.cells);
  find_neighbours(out.parts, options.halo, progress);
  return out;
}

}  // namespace teracell::store
