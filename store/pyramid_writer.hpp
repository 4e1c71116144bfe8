// Levels 3, 4, 5 ... while the levels below are being written: each gets its chunks' pieces from the level below and passes
// its own on to the next. Fed in the order of the tree (mesher/tiling.hpp), whose nodes are those of the even levels, it
// holds at most 4 x 4 pieces every other level.
#pragma once
#include "store/writer.hpp"

namespace teracell {

// A chunk of level `level` that is ready.
struct LevelChunk {
  int level;
  uint32_t cu, cv;
  std::vector<EncodedChunk> segments;  // along the rays
};

// The chunks along the rays of a block that holds whole rays. Any thread.
LevelChunk encode_level(ChunkEncoder& encoder, const Metadata& meta, int level, uint32_t cu, uint32_t cv, const Chunk& rays);

// Joins side x side pieces, each 1 / side of a chunk wide (less at the edge), into the rays of a chunk; piece (u, v) at
// v * stride + u. Pieces beyond the edge have no rays; nor has the chunk when none has. Any thread.
Chunk join_pieces(const Chunk* pieces, uint32_t side, uint32_t stride, uint32_t chunk_rays, uint32_t labels);

// Not thread-safe.
class PyramidWriter {
 public:
  explicit PyramidWriter(GridWriter& writer);
  void put(const LevelChunk& chunk);
  // The rays of chunk (cu, cv) of an even level from 2 on, one level up: they become part of the chunks above.
  // REQUIRES: tree order.
  void rise(int level, uint32_t cu, uint32_t cv, Chunk coarse);
  // Appends to `state` the chunks that are not complete; restore() puts them into a fresh writer.
  void save(Bytes& state);
  void restore(ByteReader& state);

 private:
  struct Open {
    std::array<Chunk, 16> pieces;
    uint32_t missing = 0;  // 0: not begun
  };
  GridWriter& writer_;
  ChunkEncoder encoder_;
  std::vector<Open> open_;  // of levels 2, 4 ...
};

}  // namespace teracell
