// Chunks of cells as zstd frames, made column by column: chunks in a row along the rays, since there a stored chunk is decoded once
// for all of them.
#pragma once
#include <optional>

#include "store/base/zstd_frame.hpp"
#include "tools/export/zarr/documents.hpp"

namespace teracell::exports::zarr {

// A piece of a shard of an array.
struct Column {
  const Layout* array;
  Index3 shard;
  Box chunks;  // of the array
};

// The columns of all arrays, shard by shard. They have bounded sizes.
class Columns {
 public:
  Columns(const Hierarchy& h, int64_t most_bytes) : h_(h), most_bytes_(most_bytes) {}
  std::optional<Column> next();

 private:
  const Hierarchy& h_;
  const int64_t most_bytes_;
  size_t array_ = 0;
  int64_t shard_ = 0, column_ = 0;
};

struct Frame {
  Index3 chunk;
  Bytes bytes;
};

// Keeps its memory from column to column: each thread has its own.
class ChunkMaker {
 public:
  virtual ~ChunkMaker() = default;
  // The chunks of a column in C order, without those that have nothing but the fill value.
  virtual std::vector<Frame> make(const Column& column) = 0;
};
std::unique_ptr<ChunkMaker> chunk_maker(const Hierarchy& h);

}  // namespace teracell::exports::zarr
