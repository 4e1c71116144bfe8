// Keeps the decoded chunks that were used last: those of one reader, or of all that share the memory.
#pragma once
#include "store/base/lru_cache.hpp"
#include "store/read/reader.hpp"

namespace teracell::inline store {

class KeptChunks final : public ChunkKeeper {
 public:
  using Memory = LruCache<ChunkPlace, Chunk, ChunkPlaceHash>;
  explicit KeptChunks(size_t bytes) : KeptChunks(std::make_shared<Memory>(bytes), 0) {}
  KeptChunks(std::shared_ptr<Memory> memory, uint64_t owner) : memory_(std::move(memory)), owner_(owner) {}

  std::shared_ptr<const Chunk> get(const ChunkKey& key, const Make& make) override {
    return memory_->get({owner_, key}, [&] {
      std::shared_ptr<const Chunk> chunk = make();
      const size_t bytes = chunk->memory();
      return std::pair(std::move(chunk), bytes);
    });
  }
  bool has(const ChunkKey& key) const override { return memory_->peek({owner_, key}) != nullptr; }

 private:
  const std::shared_ptr<Memory> memory_;
  const uint64_t owner_;
};

}  // namespace teracell::store
