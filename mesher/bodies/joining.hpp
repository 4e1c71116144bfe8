// Joins parts of a grid, which come in order: what is neither a chunk nor a page of one part alone.
#pragma once
#include "store/write/part.hpp"
#include "store/write/pyramid_writer.hpp"
#include "store/write/writer.hpp"

namespace teracell::mesher {

// Leaves to others what becomes of the parts' bytes.
class Joining : public PartTaker {
 public:
  Joining(GridWriter& writer, PyramidWriter& pyramid) : writer_(writer), pyramid_(pyramid) {}
  void chunk(const ChunkKey& key, ChunkEntry&& entry, uint64_t changes) override { writer_.put_entry(key, std::move(entry), changes); }
  void page(const LevelInfo& chunks, uint64_t page, uint64_t size, uint64_t checksum) override { writer_.put_page(chunks, page, size, checksum); }
  void cells(size_t channel, const ChunkKey& key, uint64_t size, uint64_t checksum) override {
    writer_.put_cells_entry(channel, key, size, checksum);
  }
  void frame(size_t channel, uint64_t size, uint64_t checksum) override { writer_.put_frame_entry(channel, size, checksum); }
  void cells_page(size_t channel, uint64_t page, uint64_t size, uint64_t checksum) override { writer_.put_cells_page(channel, page, size, checksum); }
  void child(int level, uint32_t cu, uint32_t cv, Chunk&& coarsened) override {
    const auto node = pyramid_.node_above(level, cu, cv);
    node->add(cu, cv, std::move(coarsened), encoder_);
    pyramid_.put_above(node, cu, cv);
  }

 protected:
  GridWriter& writer_;

 private:
  PyramidWriter& pyramid_;
  ChunkEncoder encoder_;
};

}  // namespace teracell::mesher
