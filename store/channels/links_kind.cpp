// The channel of links as verify() sees it: there is a link wherever the labels of neighbouring cells differ, and nowhere else.

#include <fmt/format.h>

#include "store/channels/links.hpp"
#include "store/format/cell_frames.hpp"
#include "store/format/channel_kinds.hpp"
#include "store/read/kept_chunks.hpp"
#include "store/read/reader.hpp"

namespace teracell::inline store {
namespace {

constexpr size_t kMemory = size_t{64} << 20;  // for chunks of labels: about a row of them

class LinkCheck {
 public:
  explicit LinkCheck(const GridReader& reader)
      : reader_(reader),
        shape_(reader.shape(0)),
        axes_{reader.meta().frame().u, reader.meta().frame().v, reader.meta().frame().w},
        chunks_(kMemory) {}

  // `links`: those of the chunk.
  void check(const ChunkKey& key, const ChunkLinks& links) {
    const auto own = chunk_at(key);
    const std::array<std::shared_ptr<const Chunk>, 3> next = {
        key.cu + 1 < shape_.chunks_u ? chunk_at({0, key.cu + 1, key.cv, key.segment}) : nullptr,
        key.cv + 1 < shape_.chunks_v ? chunk_at({0, key.cu, key.cv + 1, key.segment}) : nullptr,
        key.segment + 1 < shape_.segments ? chunk_at({0, key.cu, key.cv, key.segment + 1}) : nullptr};
    for (int axis = 0; axis < 3; ++axis) {
      const auto d = static_cast<size_t>(axis);
      const uint64_t expected = differences(axis, *own, next[d].get());
      if (expected != links.along[d].size())
        throw FormatError(fmt::format("along {} the labels of neighbours change {} times, but there are {} links (FORMAT.md 14.1)",
                                      axis_name(axes_[d]), expected, links.along[d].size()));
      for (const Link& link : links.along[d]) {
        Cell cell = cell_of(axis, links, link);
        const Label lower = label_of(*own, cell);
        const bool beyond = ++cell[d] == links.cells(axis);
        if (beyond) cell[d] = 0;
        if (lower == label_of(beyond ? *next[d] : *own, cell))
          throw FormatError(fmt::format("a link along {} lies between cells with the same label (FORMAT.md 14.1)", axis_name(axes_[d])));
      }
    }
  }

 private:
  using Cell = std::array<uint32_t, 3>;  // u, v, w in its chunk

  std::shared_ptr<const Chunk> chunk_at(const ChunkKey& key) {
    return chunks_.get(key, [&] {
      auto chunk = std::make_shared<Chunk>();
      reader_.read(key, *chunk);
      return chunk;
    });
  }

  static Cell cell_of(int axis, const ChunkLinks& links, const Link& link) {
    const auto across = static_cast<uint32_t>(link.line / links.row(axis)), inside = static_cast<uint32_t>(link.line % links.row(axis));
    if (axis == 0) return {link.cell, inside, across};
    if (axis == 1) return {inside, link.cell, across};
    return {inside, across, link.cell};
  }

  static Label label_of(const Chunk& chunk, const Cell& cell) { return chunk.rays.set_at(cell[1] * chunk.rays.nu + cell[0], cell[2]); }

  static uint64_t differences(const RayBlock& a, uint32_t ray_a, const RayBlock& b, uint32_t ray_b) {
    uint64_t out = 0;
    a.for_each_run(ray_a, 0, a.length, [&](uint32_t from, uint32_t to, SetId label) {
      b.for_each_run(ray_b, from, to, [&](uint32_t begin, uint32_t end, SetId other) { out += label != other ? end - begin : 0; });
    });
    return out;
  }

  // Pairs of neighbours with different labels whose lower cell lies in `own`; `next` is the chunk behind it, if there is one.
  static uint64_t differences(int axis, const Chunk& own, const Chunk* next) {
    const RayBlock& rays = own.rays;
    uint64_t out = 0;
    if (axis == 2) {
      for (uint32_t ray = 0; ray < rays.rays(); ++ray)
        out += rays.changes(ray).size() + (next && rays.sets(ray).back() != next->rays.sets(ray).front());
      return out;
    }
    for (uint32_t v = 0; v < rays.nv; ++v)
      for (uint32_t u = 0; u < rays.nu; ++u) {
        const uint32_t ray = v * rays.nu + u;
        const bool last = axis == 0 ? u + 1 == rays.nu : v + 1 == rays.nv;
        if (!last) out += differences(rays, ray, rays, ray + (axis == 0 ? 1 : rays.nu));
        else if (next) out += differences(rays, ray, next->rays, axis == 0 ? v * next->rays.nu : u);
      }
    return out;
  }

  const GridReader& reader_;
  const LevelShape shape_;
  const std::array<int, 3> axes_;  // of the rays' frame
  KeptChunks chunks_;
};

void check_links(const GridReader& reader, const Channel& channel, const std::function<Bytes(uint64_t)>& frame) {
  LinkCheck cells(reader);
  ChunkLinks links;
  check_cell_frames(reader.meta(), channel, frame, [&](const ChunkKey& key, const Bytes* bytes) {
    if (bytes) decode_links(reader.meta(), key, *bytes, links);
    else links = {};
    cells.check(key, links);
  });
}

}  // namespace

const ChannelKind kLinksKind = {kLinks, kDistances, check_links};

}  // namespace teracell::store
