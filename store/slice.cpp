#include "store/slice.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace teracell {
namespace {

void check_box(const Metadata& meta, int level, const Box& box) {
  meta.grid.check_level(level);
  const Index3 n = meta.grid.cells(level);
  for (int d = 0; d < 3; ++d)
    if (box.lo[d] < 0 || box.hi[d] > n[d])
      throw UsageError(fmt::format("the box along {} must lie in 0 to {} (half open) on level {}, found {} to {}", axis_name(d), n[d], level, box.lo[d], box.hi[d]));
}

// A box in the frame of the rays.
struct RayBox {
  int64_t u0, u1, v0, v1, w0, w1;
  RayBox(const Box& b, const Frame& f) : u0(b.lo[f.u]), u1(b.hi[f.u]), v0(b.lo[f.v]), v1(b.hi[f.v]), w0(b.lo[f.w]), w1(b.hi[f.w]) {}
};

Box intersect(const Box& a, const Box& b) {
  Box out;
  for (int d = 0; d < 3; ++d) {
    out.lo[d] = std::max(a.lo[d], b.lo[d]);
    out.hi[d] = std::min(a.hi[d], b.hi[d]);
  }
  return out;
}

// A chunk and the part of it that lies in a box, in the chunk's own rays and cells.
struct ChunkPart {
  uint32_t cu, cv, segment;
  uint32_t u0, u1, v0, v1, w0, w1;
  int64_t first_u, first_v, first_w;  // of the chunk, in the level
  bool all_rays, whole;
};

// Calls f(part) for the chunks that meet the box. REQUIRES: the box lies in the level.
template <class F>
void for_each_part(const LevelShape& s, const RayBox& b, F&& f) {
  const auto cut = [](int64_t lo, int64_t hi, int64_t first, int64_t size) {
    return std::pair{static_cast<uint32_t>(std::max<int64_t>(lo - first, 0)), static_cast<uint32_t>(std::min(hi - first, size))};
  };
  const auto chunk = [&](int64_t cu, int64_t cv, int64_t segment) {
    ChunkPart p;
    p.cu = static_cast<uint32_t>(cu), p.cv = static_cast<uint32_t>(cv), p.segment = static_cast<uint32_t>(segment);
    p.first_u = cu * s.chunk_rays, p.first_v = cv * s.chunk_rays, p.first_w = segment * s.chunk_cells;
    std::tie(p.u0, p.u1) = cut(b.u0, b.u1, p.first_u, s.rays_u(p.cu));
    std::tie(p.v0, p.v1) = cut(b.v0, b.v1, p.first_v, s.rays_v(p.cv));
    std::tie(p.w0, p.w1) = cut(b.w0, b.w1, p.first_w, s.length(p.segment));
    p.all_rays = p.u0 == 0 && p.v0 == 0 && p.u1 == s.rays_u(p.cu) && p.v1 == s.rays_v(p.cv);
    p.whole = p.all_rays && p.w0 == 0 && p.w1 == s.length(p.segment);
    f(p);
  };
  // Page by page: each page of the index is then read once.
  const int64_t side = s.page_chunks;
  const int64_t u0 = b.u0 / s.chunk_rays, u1 = (b.u1 - 1) / s.chunk_rays, v0 = b.v0 / s.chunk_rays, v1 = (b.v1 - 1) / s.chunk_rays;
  for (int64_t segment = b.w0 / s.chunk_cells; segment * s.chunk_cells < b.w1; ++segment)
    for (int64_t pv = v0 / side; pv <= v1 / side; ++pv)
      for (int64_t pu = u0 / side; pu <= u1 / side; ++pu)
        for (int64_t cv = std::max(v0, pv * side); cv <= std::min(v1, pv * side + side - 1); ++cv)
          for (int64_t cu = std::max(u0, pu * side); cu <= std::min(u1, pu * side + side - 1); ++cu) chunk(cu, cv, segment);
}

// Calls f(u, v) for the rays of a part.
template <class F>
void for_each_ray(const ChunkPart& p, F&& f) {
  for (uint32_t v = p.v0; v < p.v1; ++v)
    for (uint32_t u = p.u0; u < p.u1; ++u) f(u, v);
}

// Calls f(u, v, from, to, set id) for the runs of a part, in the chunk's own rays and cells.
template <class F>
void for_each_part_run(const RayBlock& rays, const ChunkPart& p, F&& f) {
  for (uint32_t v = p.v0; v < p.v1; ++v)
    for (uint32_t u = p.u0; u < p.u1; ++u)
      rays.for_each_run(v * rays.nu + u, [&](uint32_t from, uint32_t to, SetId set) {
        from = std::max(from, p.w0), to = std::min(to, p.w1);
        if (from < to) f(u, v, from, to, set);
      });
}

// What an index page says of a whole chunk of level 0 (store/stats.hpp), of a part.
std::vector<LabelStats> stats_of_part(const RayBlock& rays, const ChunkPart& p) {
  std::vector<LabelStats> all;
  for_each_part_run(rays, p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, SetId label) {
    auto it = std::ranges::find(all, label, &LabelStats::label);
    if (it == all.end()) it = all.insert(it, LabelStats{label, 0, {u, v, from}, {u, v, from}});
    it->cells += to - from;
    const std::array<uint32_t, 3> lo = {u, v, from}, hi = {u + 1, v + 1, to};
    for (int d = 0; d < 3; ++d) {
      it->lo[d] = std::min(it->lo[d], lo[d]);
      it->hi[d] = std::max(it->hi[d], hi[d]);
    }
  });
  return all;
}

// The same from what the index says of the whole chunk, where that is enough: the part has all rays, and all labels but one lie
// between its ends or outside. That one fills both ends of every ray, and has all the cells that are left.
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

}  // namespace

SetValue strongest_material(const Metadata& meta) {
  return [&meta](const std::vector<Label>& set) {
    uint32_t best = meta.labels[set[0]].material;
    for (const Label label : set) {
      const uint32_t m = meta.labels[label].material;
      if (meta.materials[m].rank < meta.materials[best].rank) best = m;
    }
    return best;
  };
}

std::vector<uint32_t> materials_of(const Metadata& meta, const std::vector<Label>& set) {
  std::vector<uint32_t> materials;
  for (const Label label : set) materials.push_back(meta.labels[label].material);
  std::ranges::sort(materials);
  materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
  return materials;
}

template <class T>
void read_box(const GridReader& reader, int level, const Box& box, const SetValue& value, T outside, T* data, const Index3& stride) {
  reader.meta().grid.check_level(level);
  if (box.empty()) return;
  const Box inside = intersect(box, reader.meta().grid.box(level));
  if (!(inside == box)) {
    for (int64_t z = 0; z < box.hi[2] - box.lo[2]; ++z)
      for (int64_t y = 0; y < box.hi[1] - box.lo[1]; ++y)
        for (int64_t x = 0; x < box.hi[0] - box.lo[0]; ++x) data[x * stride[0] + y * stride[1] + z * stride[2]] = outside;
  }
  if (inside.empty()) return;
  const Frame f = reader.meta().frame();
  const int64_t step_u = stride[f.u], step_v = stride[f.v], step_w = stride[f.w];
  std::shared_ptr<Chunk> scratch;
  for_each_part(reader.shape(level), RayBox(inside, f), [&](const ChunkPart& p) {
    T* origin = data + (p.first_u - box.lo[f.u]) * step_u + (p.first_v - box.lo[f.v]) * step_v + (p.first_w - box.lo[f.w]) * step_w;
    const auto fill = [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, T with) {
      T* out = origin + u * step_u + v * step_v;
      if (step_w == 1) std::fill(out + from, out + to, with);
      else
        for (uint32_t w = from; w < to; ++w) out[w * step_w] = with;
    };
    if (const auto set = reader.uniform(level, p.cu, p.cv, p.segment)) {
      const auto with = static_cast<T>(value(*set));
      return for_each_ray(p, [&](uint32_t u, uint32_t v) { fill(u, v, p.w0, p.w1, with); });
    }
    const auto held = reader.chunk(level, p.cu, p.cv, p.segment, scratch);
    const Chunk& chunk = *held;
    std::vector<std::pair<SetId, T>> values;  // of the sets met; a chunk has few
    for_each_part_run(chunk.rays, p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, SetId set) {
      auto it = std::ranges::find(values, set, &std::pair<SetId, T>::first);
      if (it == values.end()) it = values.insert(it, {set, static_cast<T>(value(chunk.sets.members(set)))});
      fill(u, v, from, to, it->second);
    });
  });
}
template void read_box(const GridReader&, int, const Box&, const SetValue&, uint8_t, uint8_t*, const Index3&);
template void read_box(const GridReader&, int, const Box&, const SetValue&, uint16_t, uint16_t*, const Index3&);
template void read_box(const GridReader&, int, const Box&, const SetValue&, uint32_t, uint32_t*, const Index3&);

void for_each_run(const GridReader& reader, int level, const Box& box, const std::function<void(const BoxRun&)>& f) {
  check_box(reader.meta(), level, box);
  if (box.empty()) return;
  const Frame frame = reader.meta().frame();
  std::shared_ptr<Chunk> scratch;
  for_each_part(reader.shape(level), RayBox(box, frame), [&](const ChunkPart& p) {
    const auto tell = [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, const std::vector<Label>& set) {
      BoxRun run{{}, to - from, &set};
      run.start[frame.u] = p.first_u + u;
      run.start[frame.v] = p.first_v + v;
      run.start[frame.w] = p.first_w + from;
      f(run);
    };
    if (const auto set = reader.uniform(level, p.cu, p.cv, p.segment)) return for_each_ray(p, [&](uint32_t u, uint32_t v) { tell(u, v, p.w0, p.w1, *set); });
    const auto held = reader.chunk(level, p.cu, p.cv, p.segment, scratch);
    const Chunk& chunk = *held;
    std::unordered_map<SetId, std::vector<Label>> sets;
    for_each_part_run(chunk.rays, p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, SetId set) {
      const auto [it, fresh] = sets.try_emplace(set);
      if (fresh) it->second = chunk.sets.members(set);
      tell(u, v, from, to, it->second);
    });
  });
}

std::vector<ColumnRun> read_column(const GridReader& reader, int axis, int64_t a, int64_t b) {
  const Metadata& meta = reader.meta();
  const Frame f = Frame::along(axis);
  const Index3 n = meta.grid.cells();
  if (a < 0 || a >= n[f.u] || b < 0 || b >= n[f.v])
    throw UsageError(fmt::format("column ({}, {}) along {} is outside the grid: {} is 0 to {}, {} is 0 to {}", a, b, axis_name(axis),
                                 axis_name(f.u), n[f.u] - 1, axis_name(f.v), n[f.v] - 1));
  Box box{{0, 0, 0}, n};
  box.lo[f.u] = a, box.hi[f.u] = a + 1;
  box.lo[f.v] = b, box.hi[f.v] = b + 1;
  std::vector<ColumnRun> runs;
  const SetValue material = strongest_material(meta);
  for_each_run(reader, 0, box, [&](const BoxRun& run) {
    const int64_t from = run.start[axis], to = from + (axis == meta.ray_axis ? run.length : 1);
    const uint32_t m = material(*run.set);
    if (!runs.empty() && runs.back().to == from && runs.back().material == m) runs.back().to = to;  // across the rays a cell at a time
    else runs.push_back({from, to, m});
  });
  std::ranges::sort(runs, {}, &ColumnRun::from);
  std::vector<ColumnRun> joined;
  for (const ColumnRun& run : runs) {
    if (!joined.empty() && joined.back().material == run.material) joined.back().to = run.to;
    else joined.push_back(run);
  }
  return joined;
}

std::vector<MaterialStats> read_stats(const GridReader& reader, const Box& box) {
  const Metadata& meta = reader.meta();
  check_box(meta, 0, box);
  const Grid& grid = meta.grid;
  const Frame f = meta.frame();
  std::vector<MaterialStats> stats(meta.materials.size());
  if (box.empty()) return stats;
  const bool graded = std::ranges::any_of(grid.axis, &Axis::is_graded);
  const auto length = [&](int axis, int64_t lo, int64_t hi) { return grid.axis[axis].plane(hi) - grid.axis[axis].plane(lo); };

  std::shared_ptr<Chunk> scratch;
  for_each_part(reader.shape(0), RayBox(box, f), [&](const ChunkPart& p) {
    const auto entry = reader.entry(0, p.cu, p.cv, p.segment);
    std::shared_ptr<const Chunk> decoded;
    const auto rays = [&]() -> const RayBlock& {
      if (!decoded) decoded = reader.chunk(0, p.cu, p.cv, p.segment, scratch);
      return decoded->rays;
    };
    std::vector<LabelStats> counted;
    if (entry->size == 0) counted = {{entry->uniform[0], uint64_t{p.u1 - p.u0} * (p.v1 - p.v0) * (p.w1 - p.w0), {p.u0, p.v0, p.w0}, {p.u1, p.v1, p.w1}}};
    else if (!p.whole) {
      auto known = stats_of_part(entry->stats, p);
      counted = known ? std::move(*known) : stats_of_part(rays(), p);
    }
    std::vector<Label> scattered;  // labels whose cells don't fill their boxes: where steps differ their volumes must be summed
    for (const LabelStats& l : entry->size != 0 && p.whole ? entry->stats : counted) {
      if (l.hi[0] > p.u1 || l.hi[1] > p.v1 || l.hi[2] > p.w1)
        throw FormatError(fmt::format("{}: level 0 chunk ({}, {}, {}): its statistics reach outside of it", reader.name(), p.cu, p.cv, p.segment));
      MaterialStats& s = stats[meta.labels[l.label].material];
      Box b;
      b.lo[f.u] = p.first_u + l.lo[0], b.lo[f.v] = p.first_v + l.lo[1], b.lo[f.w] = p.first_w + l.lo[2];
      b.hi[f.u] = p.first_u + l.hi[0], b.hi[f.v] = p.first_v + l.hi[1], b.hi[f.w] = p.first_w + l.hi[2];
      if (s.cells == 0) s.box = b;
      for (int d = 0; d < 3; ++d) {
        s.box.lo[d] = std::min(s.box.lo[d], b.lo[d]);
        s.box.hi[d] = std::max(s.box.hi[d], b.hi[d]);
      }
      s.cells += l.cells;
      if (!graded) continue;
      if (l.cells != uint64_t{l.hi[0] - l.lo[0]} * (l.hi[1] - l.lo[1]) * (l.hi[2] - l.lo[2])) scattered.push_back(l.label);
      else s.volume += length(0, b.lo[0], b.hi[0]) * length(1, b.lo[1], b.hi[1]) * length(2, b.lo[2], b.hi[2]);
    }
    if (scattered.empty()) return;
    for_each_part_run(rays(), p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, SetId label) {
      if (std::ranges::find(scattered, label) == scattered.end()) return;
      stats[meta.labels[label].material].volume +=
          length(f.u, p.first_u + u, p.first_u + u + 1) * length(f.v, p.first_v + v, p.first_v + v + 1) * length(f.w, p.first_w + from, p.first_w + to);
    });
  });
  if (!graded)
    for (MaterialStats& s : stats) s.volume = static_cast<double>(s.cells) * (grid.axis[0].step() * grid.axis[1].step() * grid.axis[2].step());
  return stats;
}

}  // namespace teracell
