#include "store/channels/link_reader.hpp"

#include <algorithm>

#include "store/runs/chunk_parts.hpp"

namespace teracell::inline store {

LinkReader::LinkReader(const GridReader& reader)
    : reader_(reader),
      chunks_(reader, find_links(reader.meta()), kLinks, nullptr, [&reader](const ChunkKey& key, const Bytes* frame, ChunkLinks& out) {
        const LevelShape s = reader.shape(0);
        if (frame) decode_links(reader.meta(), key, *frame, out);
        else out = {s.rays_u(key.cu), s.rays_v(key.cv), s.length(key.segment), {}};
      }) {}

void LinkReader::for_each(int axis, const Box& box, const std::function<void(std::span<const CellLink>)>& visit) const {
  const RayFrame f = reader_.meta().frame();
  Box inner = box;
  const Index3 n = reader_.meta().grid.cells();
  for (int d = 0; d < 3; ++d) inner.lo[d] = std::clamp<int64_t>(box.lo[d], 0, n[d]), inner.hi[d] = std::clamp<int64_t>(box.hi[d], inner.lo[d], n[d]);
  if (inner.empty()) return;
  const int along = axis == f.u ? 0 : axis == f.v ? 1 : 2;
  const int inside = along == 0 ? f.v : f.u, across = along == 2 ? f.v : f.w;  // how lines are numbered: those in a row, and rows
  const LevelShape s = reader_.shape(0);
  std::vector<CellLink> found;
  chunks_.prefetch(inner);
  for_each_part(s, RayBox(inner, f), [&](const ChunkPart& p) {
    const auto links = chunk(p.key);
    const Index3 first = f.cell(p.first_u, p.first_v, p.first_w);
    const uint32_t row = links->row(along);
    const auto& all = links->along[along];
    const auto line_of = [&](int64_t cell) { return static_cast<uint64_t>(std::clamp<int64_t>(cell - first[across], 0, ~uint32_t{0})) * row; };
    auto link = std::ranges::lower_bound(all, line_of(inner.lo[across]), {}, &Link::line);
    const auto end = std::ranges::lower_bound(all, line_of(inner.hi[across]), {}, &Link::line);
    found.clear();
    for (; link != end; ++link) {
      Index3 cell = first;
      cell[axis] += link->cell, cell[inside] += static_cast<int64_t>(link->line % row), cell[across] += static_cast<int64_t>(link->line / row);
      if (overlap(inner, {cell, {cell[0] + 1, cell[1] + 1, cell[2] + 1}})) found.push_back({cell, link->end, link->begin, link->patch});
    }
    if (!found.empty()) visit(found);
  });
}

}  // namespace teracell::store
