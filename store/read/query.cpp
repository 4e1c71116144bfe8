#include "store/read/query.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/grid/set_memo.hpp"
#include "store/runs/chunk_parts.hpp"

namespace teracell::inline store {
void for_each_run(const GridReader& reader, int level, const Box& box, const std::function<void(const BoxRun&)>& f) {
  check_box(reader.meta(), level, box);
  if (box.empty()) return;
  reader.prefetch(level, box);
  const RayFrame frame = reader.meta().frame();
  std::shared_ptr<Chunk> scratch;
  for_each_part(reader.shape(level), RayBox(box, frame), [&](const ChunkPart& p) {
    const auto tell = [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, const std::vector<Label>& set) {
      f({frame.cell(p.first_u + u, p.first_v + v, p.first_w + from), to - from, &set});
    };
    if (const auto set = reader.uniform(p.key)) return for_each_ray(p, [&](uint32_t u, uint32_t v) { tell(u, v, p.w0, p.w1, *set); });
    const auto held = reader.chunk(p.key, scratch);
    const Chunk& chunk = *held;
    SetMemo<std::vector<Label>> sets;
    for_each_part_run(chunk.rays, p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, SetId set) {
      tell(u, v, from, to, sets.get(set, [&] { return chunk.sets.members(set); }));
    });
  });
}

std::optional<uint32_t> uniform_value(const GridReader& reader, int level, const Box& box, const SetValue& value) {
  check_box(reader.meta(), level, box);
  std::optional<uint32_t> first;
  bool same = true;
  const auto see = [&](uint32_t v) {
    if (!first) first = v;
    same = same && *first == v;
  };
  std::shared_ptr<Chunk> scratch;
  for_each_part(reader.shape(level), RayBox(box, reader.meta().frame()), [&](const ChunkPart& p) {
    if (!same) return;
    if (const auto set = reader.uniform(p.key)) return see(value(*set));
    const auto chunk = reader.chunk(p.key, scratch);
    std::optional<SetId> last;
    for_each_part_run(chunk->rays, p, [&](uint32_t, uint32_t, uint32_t, uint32_t, SetId set) {
      if (same && last != set) see(value(chunk->sets.members(set)));
      last = set;
    });
  });
  return same ? first : std::nullopt;
}

std::vector<ColumnRun> read_column(const GridReader& reader, int axis, int64_t a, int64_t b, int64_t from, int64_t to) {
  const Metadata& meta = reader.meta();
  const RayFrame f = RayFrame::along(axis);
  const Index3 n = meta.grid.cells();
  if (a < 0 || a >= n[f.u] || b < 0 || b >= n[f.v])
    throw UsageError(fmt::format("column ({}, {}) along {} is outside the grid: {} is 0 to {}, {} is 0 to {}", a, b, axis_name(axis), axis_name(f.u),
                                 n[f.u] - 1, axis_name(f.v), n[f.v] - 1));
  const Box box = f.box({a, b, from}, {a + 1, b + 1, std::min(to, n[axis])});
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

}  // namespace teracell::store
