#include "store/pyramid_writer.hpp"

#include <algorithm>

#include "store/pyramid.hpp"

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

Chunk join_pieces(const std::array<Chunk, 16>& pieces, uint32_t chunk_rays, uint32_t labels) {
  std::vector<Piece> places;
  for (uint32_t i = 0; i < 16; ++i)
    if (pieces[i].rays.rays() != 0) places.push_back({i % 4 * (chunk_rays / 4), i / 4 * (chunk_rays / 4), 0, &pieces[i]});
  return join(places, labels);
}

PyramidWriter::PyramidWriter(GridWriter& writer) : writer_(writer), open_((writer.meta().grid.levels() + 1) / 2) {}

void PyramidWriter::put(const LevelChunk& chunk) {
  for (uint32_t s = 0; s < chunk.segments.size(); ++s) writer_.put(chunk.level, chunk.cu, chunk.cv, s, chunk.segments[s]);
}

void PyramidWriter::rise(int level, uint32_t cu, uint32_t cv, Chunk coarse) {
  const Metadata& meta = writer_.meta();
  const int up = level + 2;
  if (up >= meta.grid.levels()) return;
  Open& open = open_[up / 2];
  const uint32_t parent_u = cu / 4, parent_v = cv / 4;
  if (open.missing == 0) {
    const LevelShape below(meta, level);
    open.missing = std::min(4u, below.chunks_u - parent_u * 4) * std::min(4u, below.chunks_v - parent_v * 4);
  }
  open.pieces[cv % 4 * 4 + cu % 4] = std::move(coarse);
  if (--open.missing > 0) return;
  const Chunk rays = join_pieces(open.pieces, meta.chunk_rays, static_cast<uint32_t>(meta.labels.size()));
  open.pieces = {};
  put(encode_level(encoder_, meta, up, parent_u, parent_v, rays));
  Chunk above;
  above.sets = rays.sets;
  above.rays = coarsen(rays.rays, 2, above.sets);
  rise(up, parent_u, parent_v, std::move(above));
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
    open.missing = static_cast<uint32_t>(state.varint(0, 16, "missing pieces"));
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
