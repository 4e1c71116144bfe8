// Keeps the decoded chunks of one reader that were used last.
#pragma once
#include "store/reader.hpp"
#include "store/shared_cache.hpp"

namespace teracell {

struct ChunkKeyHash {
  size_t operator()(const ChunkKey& key) const {
    uint64_t h = 0;
    for (const uint64_t x : {static_cast<uint64_t>(key.level), uint64_t{key.cu}, uint64_t{key.cv}, uint64_t{key.segment}})
      h = (h ^ x) * 0x9E3779B97F4A7C15, h ^= h >> 29;
    return h;
  }
};

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

 private:
  SharedCache<ChunkKey, Chunk, ChunkKeyHash> chunks_;
};

}  // namespace teracell
