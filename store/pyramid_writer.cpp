#include "store/pyramid_writer.hpp"

#include <algorithm>

namespace teracell {

LevelChunk encode_level(ChunkEncoder& encoder, const Metadata& meta, int level, uint32_t cu, uint32_t cv, const Chunk& rays) {
  LevelChunk out{level, cu, cv, {}};
  const LevelShape shape(meta, level);
  for (uint32_t s = 0; s < shape.segments; ++s) {
    const uint32_t from = s * shape.chunk_cells;
    out.segments.push_back(shape.segments == 1 ? encode_chunk(encoder, rays.rays, rays.sets, level == 0)
                                               : encode_chunk(encoder, cut(rays.rays, from, from + shape.length(s)), rays.sets, level == 0));
  }
  return out;
}

Chunk join_pieces(const Chunk* pieces, uint32_t side, uint32_t stride, uint32_t chunk_rays, uint32_t labels) {
  std::vector<Piece> places;
  for (uint32_t v = 0; v < side; ++v)
    for (uint32_t u = 0; u < side; ++u)
      if (const Chunk& piece = pieces[v * stride + u]; piece.rays.rays() != 0)
        places.push_back({u * (chunk_rays / side), v * (chunk_rays / side), 0, &piece});
  return places.empty() ? Chunk() : join(places, labels);
}

PyramidWriter::PyramidWriter(GridWriter& writer) : writer_(writer), open_(writer.meta().grid.levels() / 2) {}

void PyramidWriter::put(const LevelChunk& chunk) {
  for (uint32_t s = 0; s < chunk.segments.size(); ++s) writer_.put({chunk.level, chunk.cu, chunk.cv, s}, chunk.segments[s]);
}

void PyramidWriter::add_to_level_above(int level, uint32_t cu, uint32_t cv, Chunk coarsened) {
  const Metadata& meta = writer_.meta();
  const int levels = meta.grid.levels();
  if (level + 1 >= levels) return;
  Open& open = open_[level / 2 - 1];
  const uint32_t parent_u = cu / kFanOut, parent_v = cv / kFanOut;
  if (open.missing == 0) {
    const LevelShape below(meta, level);
    open.missing = std::min(kFanOut, below.chunks_u - parent_u * kFanOut) * std::min(kFanOut, below.chunks_v - parent_v * kFanOut);
  }
  open.pieces[cv % kFanOut * kFanOut + cu % kFanOut] = std::move(coarsened);
  if (--open.missing > 0) return;
  // First the 2 x 2 chunks of the odd level between, then from them the chunk of the even level above.
  const auto labels = static_cast<uint32_t>(meta.labels.size());
  std::array<Chunk, 4> quarters;
  for (uint32_t q = 0; q < 4; ++q) {
    const Chunk rays = join_pieces(&open.pieces[size_t{2} * (q / 2 * kFanOut + q % 2)], 2, kFanOut, meta.chunk_rays, labels);
    if (rays.rays.rays() == 0) continue;
    put(encode_level(encoder_, meta, level + 1, parent_u * 2 + q % 2, parent_v * 2 + q / 2, rays));
    if (level + 2 < levels) quarters[q] = coarsen(rays, 1);
  }
  open.pieces = {};
  if (level + 2 >= levels) return;
  const Chunk above = join_pieces(quarters.data(), 2, 2, meta.chunk_rays, labels);
  put(encode_level(encoder_, meta, level + 2, parent_u, parent_v, above));
  if (level + 3 < levels) add_to_level_above(level + 2, parent_u, parent_v, coarsen(above, 1));
}

void PyramidWriter::save(Bytes& state) {
  for (const Open& open : open_) {
    put_varint(state, open.missing);
    if (open.missing == 0) continue;
    for (const Chunk& piece : open.pieces) {
      put_varint(state, piece.rays.nu);
      if (piece.rays.nu == 0) continue;
      put_varint(state, piece.rays.nv);
      put_varint(state, piece.rays.length);
      const Bytes frame = encoder_.encode(piece.rays, piece.sets);
      put_varint(state, frame.size());
      state.insert(state.end(), frame.begin(), frame.end());
    }
  }
}

void PyramidWriter::restore(ByteReader& state) {
  const Metadata& meta = writer_.meta();
  ChunkDecoder decoder;
  for (Open& open : open_) {
    open.missing = static_cast<uint32_t>(state.varint(0, kChildren, "missing pieces"));
    if (open.missing == 0) continue;
    for (Chunk& piece : open.pieces) {
      const auto nu = static_cast<uint32_t>(state.varint(0, meta.chunk_rays, "rays"));
      if (nu == 0) continue;
      const auto nv = static_cast<uint32_t>(state.varint(1, meta.chunk_rays, "rays"));
      const auto length = static_cast<uint32_t>(state.varint(1, Axis::kMaxCells, "cells"));
      decoder.decode(state.take(state.varint()), nu, nv, length, static_cast<uint32_t>(meta.labels.size()), piece);
    }
  }
}

}  // namespace teracell
