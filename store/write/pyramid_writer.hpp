// The levels above 2, made while the levels below them are written: each chunk is coarsened and becomes a part of the chunk
// above it. The threads that make the chunks make these too. One thread puts all into the file, in the order of the tree of
// chunks (kFanOut in pyramid.hpp); on every other level it holds the children of one chunk that is not put yet.
#pragma once
#include <atomic>
#include <exception>
#include <memory>

#include "store/runs/pyramid.hpp"
#include "store/write/chunk_sink.hpp"

namespace teracell::inline store {

// The chunks of a block of whole rays, ready to be written: one for each segment.
struct LevelChunk {
  int level = 0;
  uint32_t cu = 0, cv = 0;
  std::vector<EncodedChunk> segments;
};

// Cuts a block of whole rays into its segments and encodes them. Any thread.
LevelChunk encode_level(ChunkEncoder& encoder, const Metadata& meta, int level, uint32_t cu, uint32_t cv, const Chunk& rays);

// Joins side x side pieces, each 1 / side of a chunk wide (less at the edge), into the rays of a chunk. Piece (u, v) is
// pieces[v * stride + u]. Pieces beyond the edge have no rays; if none has any, neither has the result. Any thread.
Chunk join_pieces(const Chunk* pieces, uint32_t side, uint32_t stride, uint32_t chunk_rays, uint32_t labels);

// A chunk of an even level above 2 and the 2 x 2 chunks of the odd level below it. They are made of up to 16 chunks of the even
// level below that, their children.
class PyramidNode {
 public:
  // Adds the child (cu, cv), coarsened by one level. The thread that adds the last child of a quarter makes the quarter, and of the last
  // quarter also the even level, which it adds to the node above. (When the whole node waited for its last child, a small grid had all of
  // its upper levels made at the end, by one thread: 1.5 of 75 ms at 1000 x 1000 rays.) Any thread.
  void add(uint32_t cu, uint32_t cv, Chunk coarsened, ChunkEncoder& encoder);

 private:
  friend class PyramidWriter;
  PyramidNode(const Metadata& meta, int level, uint32_t u, uint32_t v, bool whole, std::shared_ptr<PyramidNode> above);
  void make_quarter(uint32_t q, ChunkEncoder& encoder);
  void make_even(ChunkEncoder& encoder);

  const Metadata& meta_;
  const int level_;  // of the children
  const uint32_t u_, v_;
  const bool whole_;  // false: other parts of the grid have the other children
  const std::shared_ptr<PyramidNode> above_;  // null at the top
  std::array<Chunk, kChildren> children_;     // a checkpoint may need them until the node is put
  std::array<std::atomic<uint32_t>, 4> missing_{};  // children, by quarter
  std::atomic<uint32_t> quarters_left_ = 0;
  std::array<LevelChunk, 4> odd_;  // by quarter, without segments where there is none
  std::array<Chunk, 4> quarters_;  // the same, coarsened
  std::array<std::exception_ptr, 4> failed_;
  LevelChunk even_;
  uint32_t unput_;                        // children that are not put yet
  std::array<bool, kChildren> put_ = {};  // whether a child is
};

class PyramidWriter {
 public:
  // What goes into `sink` is what lies in `range`.
  explicit PyramidWriter(ChunkSink& sink, const TreeRange& range = {});
  // The node to which chunk (cu, cv) of an even level is to be added; null when there is none. REQUIRES: tree order. One thread at a
  // time, which may be another than the one that puts.
  std::shared_ptr<PyramidNode> node_above(int level, uint32_t cu, uint32_t cv);

  ChunkSink& sink() { return sink_; }
  // One thread puts, in tree order.
  void put(const LevelChunk& chunk);
  // To be called when chunk (cu, cv) has been put and added to its node: puts the nodes that are complete by this. A node that is not
  // whole is not made: its children are put.
  void put_above(const std::shared_ptr<PyramidNode>& node, uint32_t cu, uint32_t cv);
  // Appends what has been put of nodes that are not complete to `state`; restore() puts it into a fresh writer.
  void save(Bytes& state);
  void restore(ByteReader& state);

 private:
  ChunkSink& sink_;
  const TreeRange range_;
  std::vector<std::shared_ptr<PyramidNode>> path_;         // the nodes that were asked for last, on levels 2, 4 ...
  std::vector<std::array<Chunk, kChildren>> restored_;     // the children of nodes on path_ that are not made yet
  std::shared_ptr<PyramidNode> at_;                        // the node that had a child put last
};

}  // namespace teracell::store
