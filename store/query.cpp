#include "store/query.hpp"

#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>

#include "store/chunk_parts.hpp"

namespace teracell {
namespace {

Box intersect(const Box& a, const Box& b) {
  Box out;
  for (int d = 0; d < 3; ++d) {
    out.lo[d] = std::max(a.lo[d], b.lo[d]);
    out.hi[d] = std::min(a.hi[d], b.hi[d]);
  }
  return out;
}

}  // namespace

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
  const RayFrame f = reader.meta().frame();
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
    if (const auto set = reader.uniform(p.key)) {
      const auto with = static_cast<T>(value(*set));
      return for_each_ray(p, [&](uint32_t u, uint32_t v) { fill(u, v, p.w0, p.w1, with); });
    }
    const auto held = reader.chunk(p.key, scratch);
    const Chunk& chunk = *held;
    std::vector<std::pair<SetId, T>> values;  // of the sets that occurred; a chunk has few
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
  const RayFrame frame = reader.meta().frame();
  std::shared_ptr<Chunk> scratch;
  for_each_part(reader.shape(level), RayBox(box, frame), [&](const ChunkPart& p) {
    const auto tell = [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, const std::vector<Label>& set) {
      BoxRun run{{}, to - from, &set};
      run.start[frame.u] = p.first_u + u;
      run.start[frame.v] = p.first_v + v;
      run.start[frame.w] = p.first_w + from;
      f(run);
    };
    if (const auto set = reader.uniform(p.key)) return for_each_ray(p, [&](uint32_t u, uint32_t v) { tell(u, v, p.w0, p.w1, *set); });
    const auto held = reader.chunk(p.key, scratch);
    const Chunk& chunk = *held;
    std::unordered_map<SetId, std::vector<Label>> sets;
    for_each_part_run(chunk.rays, p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, SetId set) {
      const auto [it, fresh] = sets.try_emplace(set);
      if (fresh) it->second = chunk.sets.members(set);
      tell(u, v, from, to, it->second);
    });
  });
}

std::vector<ColumnRun> read_column(const GridReader& reader, int axis, int64_t a, int64_t b, int64_t from, int64_t to) {
  const Metadata& meta = reader.meta();
  const RayFrame f = RayFrame::along(axis);
  const Index3 n = meta.grid.cells();
  if (a < 0 || a >= n[f.u] || b < 0 || b >= n[f.v])
    throw UsageError(fmt::format("column ({}, {}) along {} is outside the grid: {} is 0 to {}, {} is 0 to {}", a, b, axis_name(axis), axis_name(f.u),
                                 n[f.u] - 1, axis_name(f.v), n[f.v] - 1));
  Box box{{0, 0, 0}, n};
  box.lo[f.u] = a, box.hi[f.u] = a + 1;
  box.lo[f.v] = b, box.hi[f.v] = b + 1;
  box.lo[axis] = from, box.hi[axis] = std::min(to, n[axis]);
  std::vector<ColumnRun> runs;
  const SetValue material = strongest_material(meta);
  for_each_run(reader, 0, box, [&](const BoxRun& run) {
    const int64_t begin = run.start[axis], end = begin + (axis == meta.ray_axis ? run.length : 1);
    const uint32_t m = material(*run.set);
    if (!runs.empty() && runs.back().to == begin && runs.back().material == m) runs.back().to = end;  // across the rays, runs come cell by cell
    else runs.push_back({begin, end, m});
  });
  std::ranges::sort(runs, {}, &ColumnRun::from);
  std::vector<ColumnRun> joined;
  for (const ColumnRun& run : runs) {
    if (!joined.empty() && joined.back().material == run.material) joined.back().to = run.to;
    else joined.push_back(run);
  }
  return joined;
}

}  // namespace teracell
