// What takes the chunks of a grid as they are made, in the order of the tree (pyramid.hpp): a file of the grid, or one of a part of it.
#pragma once
#include "store/format/format.hpp"
#include "store/grid/metadata.hpp"
#include "store/runs/chunk_codec.hpp"

namespace teracell::inline store {

// A chunk that is ready to be written. Any thread may make it.
struct EncodedChunk {
  Bytes frame;       // empty when the chunk is uniform
  ChunkEntry entry;  // without the offset
  uint64_t changes = 0;
};
EncodedChunk encode_chunk(ChunkEncoder& encoder, const RayBlock& rays, const SetTable& sets, bool with_stats);

class ChunkSink {
 public:
  virtual ~ChunkSink() = default;
  virtual const Metadata& meta() const = 0;
  virtual void put(const ChunkKey& key, const EncodedChunk& chunk) = 0;
  // The rays of chunk (cu, cv) of an even level, coarsened by one level, where other parts hold the rest of what the chunk above it is
  // made of.
  virtual void put_child(int level, uint32_t cu, uint32_t cv, const Chunk& coarsened) = 0;
  // What another channel of meta() has for a chunk of level 0: a frame, or nothing. To be called for every chunk of level 0 in tree order.
  virtual void put_cells(size_t channel, const ChunkKey& key, std::span<const uint8_t> frame) = 0;
  virtual uint64_t bytes() const = 0;   // written so far
  virtual uint64_t chunks() const = 0;  // that are not uniform, put so far
  // Makes what was put durable and appends to `state` what a writer needs to go on from here.
  virtual void save(Bytes& state) = 0;
};

}  // namespace teracell::store
