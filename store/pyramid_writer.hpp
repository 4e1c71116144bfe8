// Levels 2, 4, 6 ... while level 0 is being written: each gets its chunks' pieces from the level below and passes its
// own on to the next. Fed in the order of the tree (mesher/tiling.hpp) it holds at most one unfinished chunk a level.
#pragma once
#include "store/writer.hpp"

namespace teracell {

// A chunk of level `level` that is ready, and what it becomes two levels up: a quarter of the rays each way.
struct LevelChunk {
  int level;
  uint32_t cu, cv;
  std::vector<EncodedChunk> segments;  // along the rays
};

// The chunks along the rays of a block that holds whole rays. Any thread.
LevelChunk encode_level(ChunkEncoder& encoder, const Metadata& meta, int level, uint32_t cu, uint32_t cv, const Chunk& rays);

// Joins 4 x 4 pieces, each a quarter of a chunk wide (less at the edge), into the rays of a chunk; piece (u, v) at v * 4 + u.
// Pieces beyond the edge have no rays. Any thread.
Chunk join_pieces(const std::array<Chunk, 16>& pieces, uint32_t chunk_rays, uint32_t labels);

// Not thread-safe.
class PyramidWriter {
 public:
  explicit PyramidWriter(GridWriter& writer);
  void put(const LevelChunk& chunk);
  // The rays of chunk (cu, cv) of `level`, two levels up: becomes part of chunk (cu / 4, cv / 4) of level + 2. Does
  // nothing when there is no such level. REQUIRES: tree order.
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
  std::vector<Open> open_;  // level / 2
};

}  // namespace teracell
