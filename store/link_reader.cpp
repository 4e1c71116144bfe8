#include "store/link_reader.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/chunk_parts.hpp"

namespace teracell {

LinkReader::LinkReader(const GridReader& reader, size_t bytes)
    : reader_(reader),
      channel_([&]() -> const Channel& {
        if (const Channel* found = find_links(reader.meta())) return *found;
        throw UsageError(fmt::format("{}: the grid has no links: it was meshed without them", reader.name()));
      }()),
      chunks_(bytes) {}

std::shared_ptr<const ChunkLinks> LinkReader::chunk(const ChunkKey& key) const {
  if (auto kept = chunks_.find(key)) return kept;
  auto links = std::make_shared<ChunkLinks>();
  thread_local Bytes frame;
  try {
    if (reader_.read_cells(channel_, key, frame)) decode_links(reader_.meta(), key, frame, *links);
    else {
      const LevelShape s = reader_.shape(0);
      *links = {s.rays_u(key.cu), s.rays_v(key.cv), s.length(key.segment), {}};
    }
  } catch (const FormatError& e) {
    const std::string message = e.what();
    throw FormatError(message.starts_with(reader_.name()) ? message : fmt::format("{}: {}: {}", reader_.name(), chunk_name(key), message));
  }
  chunks_.add(key, links, links->memory());
  return links;
}

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
  for_each_part(s, RayBox(inner, f), [&](const ChunkPart& p) {
    const auto links = chunk(p.key);
    Index3 first;
    first[f.u] = int64_t{p.key.cu} * s.chunk_rays, first[f.v] = int64_t{p.key.cv} * s.chunk_rays, first[f.w] = int64_t{p.key.segment} * s.chunk_cells;
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

}  // namespace teracell
