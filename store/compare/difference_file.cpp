#include "store/compare/difference_file.hpp"

#include <array>

#include "store/base/in_order.hpp"
#include "store/write/pyramid_writer.hpp"
#include "store/write/tree_order.hpp"
#include "store/write/writer.hpp"

namespace teracell::inline store {
namespace {

// Before each block: the offset of the block before it of the same chunk, its first cell, its cells, the bytes of its frame.
constexpr size_t kHeadBytes = 24;

// The numbers in a block become labels. No two numbers become the same label, so its patterns stay different.
void relabel(Chunk& chunk, const std::vector<Label>& label_of, uint32_t labels) {
  PatternTable patterns;
  std::vector<SetId> sets;
  for (uint32_t p = 0; p < chunk.rays.patterns.size(); ++p) {
    sets.clear();
    for (const SetId number : chunk.rays.patterns.sets(p)) sets.push_back(label_of[number]);
    patterns.intern(sets);
  }
  chunk.rays.patterns = std::move(patterns);
  chunk.sets = SetTable(labels);
}

// 4 x 4 chunks, the chunk of level 2 above them, and what they add to the levels above that.
struct GroupOfChunks {
  std::pair<uint32_t, uint32_t> place;
  std::shared_ptr<PyramidNode> above;
  std::vector<LevelChunk> chunks;
  uint64_t changes = 0;
};

}  // namespace

SpilledChanges::SpilledChanges(const std::filesystem::path& folder, const Metadata& meta)
    : shape_(meta, 0), file_(folder, 0), end_(uint64_t{shape_.chunks_u} * shape_.chunks_v * 8) {
  const std::array<uint8_t, 8> zero{};
  file_.write(end_ - zero.size(), zero);
}

void SpilledChanges::put(uint32_t cu, uint32_t cv, uint32_t first, uint32_t length, std::span<const uint8_t> frame) {
  Bytes place(8), head;
  file_.read(place_of(cu, cv), place);
  head = place;
  put_fixed<uint32_t>(head, first);
  put_fixed<uint32_t>(head, length);
  put_fixed<uint64_t>(head, frame.size());
  file_.write(end_, head);
  file_.write(end_ + head.size(), frame);
  place.clear();
  put_fixed<uint64_t>(place, end_);
  file_.write(place_of(cu, cv), place);
  end_ += head.size() + frame.size();
}

Chunk SpilledChanges::take(uint32_t cu, uint32_t cv, const std::vector<Label>& label_of, ChunkDecoder& decoder) const {
  const auto labels = static_cast<uint32_t>(label_of.size());
  const uint32_t nu = shape_.rays_u(cu), nv = shape_.rays_v(cv);
  struct Block {
    uint32_t first, end;
    Chunk chunk;
  };
  std::vector<Block> blocks;  // the last one first
  const auto add_same = [&](uint32_t first, uint32_t end) {
    if (first == end) return;
    blocks.push_back({first, end, {{}, SetTable(labels)}});
    blocks.back().chunk.rays.fill(nu, nv, end - first, 0);
  };
  Bytes head(8), frame;
  file_.read(place_of(cu, cv), head);
  uint32_t begin = shape_.nw;  // of what is there already
  for (uint64_t at = ByteReader(head, "").fixed<uint64_t>(); at != 0;) {
    head.resize(kHeadBytes);
    file_.read(at, head);
    ByteReader in(head, "block of changes");
    const uint64_t before = in.fixed<uint64_t>();
    const uint32_t first = in.fixed<uint32_t>(), length = in.fixed<uint32_t>();
    frame.resize(in.fixed<uint64_t>());
    file_.read(at + kHeadBytes, frame);
    add_same(first + length, begin);
    blocks.push_back({first, first + length, {}});
    decoder.decode(frame, nu, nv, length, labels, blocks.back().chunk);
    relabel(blocks.back().chunk, label_of, labels);
    begin = first;
    at = before;
  }
  add_same(0, begin);
  if (blocks.size() == 1) return std::move(blocks[0].chunk);
  std::vector<Piece> pieces;
  for (const Block& b : blocks) pieces.push_back({0, 0, b.first, &b.chunk});
  return join(pieces, labels);
}

void write_changes(const std::filesystem::path& path, const Metadata& meta, const SpilledChanges& changes, const std::vector<Label>& label_of,
                   const std::string& report, int threads, const std::function<void(double)>& progress) {
  GridWriter writer(path, meta);
  PyramidWriter pyramid(writer);
  const LevelShape shape(meta, 0), above(meta, 2);
  const auto labels = static_cast<uint32_t>(meta.labels.size());
  const int levels = meta.grid.levels();
  TreeOrder order(above.chunks_u, above.chunks_v);
  std::vector<ChunkEncoder> encoders(static_cast<size_t>(threads));
  std::vector<ChunkDecoder> decoders(static_cast<size_t>(threads));
  uint64_t done = 0, all_changes = 0;
  in_order(
      threads,
      [&]() -> std::optional<GroupOfChunks> {
        const auto place = order.next();
        if (!place) return std::nullopt;
        return GroupOfChunks{*place, levels > 2 ? pyramid.node_above(2, place->first, place->second) : nullptr, {}, 0};
      },
      [&](GroupOfChunks group, int worker) {
        const auto [gu, gv] = group.place;
        ChunkEncoder& encoder = encoders[static_cast<size_t>(worker)];
        std::array<Chunk, kChildren> pieces;
        for (uint32_t i = 0; i < kChildren; ++i) {
          const uint32_t cu = gu * kFanOut + i % kFanOut, cv = gv * kFanOut + i / kFanOut;
          if (cu >= shape.chunks_u || cv >= shape.chunks_v) continue;
          const Chunk fine = changes.take(cu, cv, label_of, decoders[static_cast<size_t>(worker)]);
          group.changes += fine.rays.at.size();
          group.chunks.push_back(encode_level(encoder, meta, 0, cu, cv, fine));
          pieces[i] = coarsen(fine, 2);
        }
        if (levels <= 2) return group;
        const Chunk level2 = join_pieces(pieces.data(), kFanOut, kFanOut, meta.chunk_rays, labels);
        group.chunks.push_back(encode_level(encoder, meta, 2, gu, gv, level2));
        if (group.above) group.above->add(gu, gv, coarsen(level2, 1), encoder);
        return group;
      },
      [&](const GroupOfChunks& group) {
        for (const LevelChunk& chunk : group.chunks) pyramid.put(chunk);
        pyramid.put_above(group.above, group.place.first, group.place.second);
        all_changes += group.changes;
        progress(static_cast<double>(++done) / static_cast<double>(uint64_t{above.chunks_u} * above.chunks_v));
      });
  writer.finish(report, all_changes);
}

}  // namespace teracell::store
