// Keeps the decoded chunks of one reader that were used last.
#pragma once
#include "store/base/shared_cache.hpp"
#include "store/read/reader.hpp"

namespace teracell::inline store {

class KeptChunks final : public ChunkKeeper {
 public:
  explicit KeptChunks(size_t bytes) : chunks_(bytes) {}
  std::shared_ptr<const Chunk> get(const ChunkKey& key, const Make& make) override {
    return chunks_.get(key, [&] {
      std::shared_ptr<const Chunk> chunk = make();
      const size_t bytes = chunk->memory();
      return std::pair(std::move(chunk), bytes);
    });
  }
  bool has(const ChunkKey& key) const override { return chunks_.find(key) != nullptr; }

 private:
  mutable SharedCache<ChunkKey, Chunk, ChunkKeyHash> chunks_;
};

}  // namespace teracell::store
