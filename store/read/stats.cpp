#include "store/read/stats.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/grid/set_memo.hpp"
#include "store/runs/chunk_parts.hpp"

namespace teracell::inline store {
namespace {

// The statistics of a part of a chunk of level 0, counted from its runs.
std::vector<LabelStats> stats_of_part(const RayBlock& rays, const ChunkPart& p) {
  SetMemo<LabelStats> all;
  for_each_part_run(rays, p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, SetId label) {
    LabelStats& stats = all.get(label, [&] { return LabelStats{label, 0, {u, v, from}, {u, v, from}}; });
    stats.cells += to - from;
    const std::array<uint32_t, 3> lo = {u, v, from}, hi = {u + 1, v + 1, to};
    for (int d = 0; d < 3; ++d) {
      stats.lo[d] = std::min(stats.lo[d], lo[d]);
      stats.hi[d] = std::max(stats.hi[d], hi[d]);
    }
  });
  return all.values();
}

// The same from the index's statistics of the whole chunk, where these are enough: the part has all rays, and the cells of
// all labels but one lie either between its ends or outside. That one label fills both ends of every ray, and all the cells
// of the part that are left.
std::optional<std::vector<LabelStats>> stats_of_part(const std::vector<LabelStats>& whole, const ChunkPart& p) {
  if (!p.all_rays) return std::nullopt;
  std::vector<LabelStats> all;
  uint64_t left = uint64_t{p.u1} * p.v1 * (p.w1 - p.w0);
  std::optional<Label> rest;
  for (const LabelStats& l : whole) {
    if (l.lo[2] >= p.w1 || l.hi[2] <= p.w0) continue;
    const bool between = l.lo[2] > p.w0 && l.hi[2] < p.w1;
    if ((!between && rest) || l.cells > left) return std::nullopt;
    if (!between) rest = l.label;
    else all.push_back(l), left -= l.cells;
  }
  if (!rest) return std::nullopt;
  all.push_back({*rest, left, {0, 0, p.w0}, {p.u1, p.v1, p.w1}});
  return all;
}

// Adds what lies in a box to what is known already; both have cells.
void add(CellStats& to, unsigned __int128 cells, double volume, const Box& box) {
  if (to.cells == 0) to.box = box;
  for (int d = 0; d < 3; ++d) {
    to.box.lo[d] = std::min(to.box.lo[d], box.lo[d]);
    to.box.hi[d] = std::max(to.box.hi[d], box.hi[d]);
  }
  to.cells += cells;
  to.volume += volume;
}

// Where the cells lie that the statistics of a part of a chunk are of.
Box box_of(const GridReader& reader, const ChunkPart& p, const LabelStats& l) {
  if (l.hi[0] > p.u1 || l.hi[1] > p.v1 || l.hi[2] > p.w1)
    throw FormatError(fmt::format("{}: {}: its statistics reach outside of it (FORMAT.md 10.3)", reader.name(), chunk_name(p.key)));
  return reader.meta().frame().box({p.first_u + l.lo[0], p.first_v + l.lo[1], p.first_w + l.lo[2]},
                                   {p.first_u + l.hi[0], p.first_v + l.hi[1], p.first_w + l.hi[2]});
}

bool is_graded(const Grid& grid) { return std::ranges::any_of(grid.axis, &Axis::is_graded); }

// Where all cells are alike, a volume is a multiple of theirs.
void set_uniform_volumes(const Grid& grid, std::vector<CellStats>& stats) {
  if (is_graded(grid)) return;
  for (CellStats& s : stats) s.volume = static_cast<double>(s.cells) * (grid.axis[0].step() * grid.axis[1].step() * grid.axis[2].step());
}

}  // namespace

std::vector<CellStats> read_label_stats(const GridReader& reader, const Box& box) {
  const Metadata& meta = reader.meta();
  check_box(meta, 0, box);
  const Grid& grid = meta.grid;
  const RayFrame f = meta.frame();
  std::vector<CellStats> stats(meta.labels.size());
  if (box.empty()) return stats;
  const bool graded = is_graded(grid);
  if (!meta.amounts.empty() && box == grid.box(0) && !graded) {  // where cells differ, the volumes are not known yet
    for (size_t l = 0; l < stats.size(); ++l) stats[l].cells = meta.amounts[l].cells, stats[l].box = meta.amounts[l].box;
    set_uniform_volumes(grid, stats);
    return stats;
  }
  const auto length = [&](int axis, int64_t lo, int64_t hi) { return grid.axis[axis].plane(hi) - grid.axis[axis].plane(lo); };

  reader.prefetch(0, box, false);
  std::shared_ptr<Chunk> scratch;
  for_each_part(reader.shape(0), RayBox(box, f), [&](const ChunkPart& p) {
    const auto entry = reader.entry(p.key);
    std::shared_ptr<const Chunk> decoded;
    const auto rays = [&]() -> const RayBlock& {
      if (!decoded) decoded = reader.chunk(p.key, scratch);
      return decoded->rays;
    };
    std::vector<LabelStats> counted;
    if (entry->size == 0)
      counted = {{entry->uniform[0], uint64_t{p.u1 - p.u0} * (p.v1 - p.v0) * (p.w1 - p.w0), {p.u0, p.v0, p.w0}, {p.u1, p.v1, p.w1}}};
    else if (!p.whole) {
      auto known = stats_of_part(entry->stats, p);
      counted = known ? std::move(*known) : stats_of_part(rays(), p);
    }
    std::vector<Label> scattered;  // labels whose cells don't fill their boxes: on a graded axis their volumes are summed run by run
    for (const LabelStats& l : entry->size != 0 && p.whole ? entry->stats : counted) {
      const Box b = box_of(reader, p, l);
      const bool fills = l.cells == uint64_t{l.hi[0] - l.lo[0]} * (l.hi[1] - l.lo[1]) * (l.hi[2] - l.lo[2]);
      const double volume = graded && fills ? length(0, b.lo[0], b.hi[0]) * length(1, b.lo[1], b.hi[1]) * length(2, b.lo[2], b.hi[2]) : 0;
      add(stats[l.label], l.cells, volume, b);
      if (graded && !fills) scattered.push_back(l.label);
    }
    if (scattered.empty()) return;
    SetMemo<bool> is_scattered;
    for_each_part_run(rays(), p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, SetId label) {
      if (!is_scattered.get(label, [&] { return std::ranges::find(scattered, label) != scattered.end(); })) return;
      stats[label].volume += length(f.u, p.first_u + u, p.first_u + u + 1) * length(f.v, p.first_v + v, p.first_v + v + 1) *
                             length(f.w, p.first_w + from, p.first_w + to);
    });
  });
  set_uniform_volumes(grid, stats);
  return stats;
}

Box read_box_of(const GridReader& reader, const std::vector<bool>& labels) {
  const Metadata& meta = reader.meta();
  LabelAmount sum;
  for (size_t l = 0; l < meta.amounts.size(); ++l)
    if (labels[l] && meta.amounts[l].cells != 0) sum.add(1, meta.amounts[l].box);
  if (!meta.amounts.empty()) return sum.box;
  const Box all = meta.grid.box(0);
  reader.prefetch(0, all, false);
  for_each_part(reader.shape(0), RayBox(all, meta.frame()), [&](const ChunkPart& p) {
    const auto entry = reader.entry(p.key);
    if (entry->size == 0 && labels[entry->uniform[0]]) sum.add(1, box_of(reader, p, {entry->uniform[0], 1, {0, 0, 0}, {p.u1, p.v1, p.w1}}));
    else if (entry->size != 0)
      for (const LabelStats& l : entry->stats)
        if (labels[l.label]) sum.add(1, box_of(reader, p, l));
  });
  return sum.box;
}

std::vector<CellStats> stats_by_material(const Metadata& meta, const std::vector<CellStats>& of_labels) {
  std::vector<CellStats> stats(meta.materials.size());
  for (size_t label = 0; label < of_labels.size(); ++label)
    if (const CellStats& s = of_labels[label]; s.cells != 0) add(stats[meta.labels[label].material], s.cells, s.volume, s.box);
  set_uniform_volumes(meta.grid, stats);
  return stats;
}

std::vector<CellStats> read_stats(const GridReader& reader, const Box& box) {
  return stats_by_material(reader.meta(), read_label_stats(reader, box));
}

}  // namespace teracell::store
