// The levels above 2, made while the levels below them are written: each chunk is coarsened and becomes a part of the chunk
// above it. Fed in the order of the tree of chunks (kFanOut in pyramid.hpp), a writer holds the children of at most one
// unfinished chunk on every other level.
#pragma once
#include "store/pyramid.hpp"
#include "store/writer.hpp"

namespace teracell {

// The chunks of a block of whole rays, ready to be written: one for each segment.
struct LevelChunk {
  int level;
  uint32_t cu, cv;
  std::vector<EncodedChunk> segments;
};

// Cuts a block of whole rays into its segments and encodes them. Any thread.
LevelChunk encode_level(ChunkEncoder& encoder, const Metadata& meta, int level, uint32_t cu, uint32_t cv, const Chunk& rays);

// Joins side x side pieces, each 1 / side of a chunk wide (less at the edge), into the rays of a chunk. Piece (u, v) is
// pieces[v * stride + u]. Pieces beyond the edge have no rays; if none has any, neither has the result. Any thread.
Chunk join_pieces(const Chunk* pieces, uint32_t side, uint32_t stride, uint32_t chunk_rays, uint32_t labels);

// Not thread-safe.
class PyramidWriter {
 public:
  explicit PyramidWriter(GridWriter& writer);
  void put(const LevelChunk& chunk);
  // Adds the rays of chunk (cu, cv) of `level`, coarsened by one level, to the chunks of the level above. Those that are
  // complete by this are put, and so are their own parents. REQUIRES: the level is even and at least 2; tree order.
  void add_to_level_above(int level, uint32_t cu, uint32_t cv, Chunk coarsened);
  // Appends the chunks that are not complete to `state`; restore() puts them into a fresh writer.
  void save(Bytes& state);
  void restore(ByteReader& state);

 private:
  struct Open {
    std::array<Chunk, kChildren> pieces;
    uint32_t missing = 0;  // 0: not begun
  };
  GridWriter& writer_;
  ChunkEncoder encoder_;
  std::vector<Open> open_;  // of levels 2, 4 ...
};

}  // namespace teracell
