// Blocks of a far source, kept in memory and perhaps on disk. What is read is fetched in whole blocks; neighbouring blocks are fetched
// together, and several stretches at the same time. Of threads that want the same block, one fetches it.
#pragma once
#include <array>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "store/base/file.hpp"
#include "store/base/lru_cache.hpp"
#include "store/base/system/once.hpp"
#include "store/remote/block_folder.hpp"

namespace teracell::inline store {

struct SourceBlock {
  uint64_t source, block;
  friend bool operator==(const SourceBlock&, const SourceBlock&) = default;
};
struct SourceBlockHash {
  size_t operator()(const SourceBlock& p) const { return (p.source * 0x9E3779B97F4A7C15 ^ p.block) * 0x9E3779B97F4A7C15 >> 16; }
};

// The blocks in memory. Sources that share it share its memory. Threads may share it.
class BlockCache : public LruCache<SourceBlock, Bytes, SourceBlockHash> {
 public:
  using LruCache::LruCache;
};

// Threads may share it.
class CachedSource : public ByteSource {
 public:
  // Bytes that are known already, and stay.
  struct Kept {
    uint64_t offset = 0;
    Bytes bytes;
  };
  CachedSource(std::unique_ptr<ByteSource> far, std::unique_ptr<BlockFolder> disk, Kept kept, std::shared_ptr<BlockCache> cache);

  uint64_t size() const override { return far_->size(); }
  const std::string& name() const override { return far_->name(); }
  void read(uint64_t offset, std::span<uint8_t> out) const override;
  bool is_far() const override { return far_->is_far(); }
  // Fetches what is missing, up to half of what fits into memory.
  void prefetch(std::span<const ByteRange> soon) const override;
  bool was_replaced() const override { return far_->was_replaced(); }

  static constexpr uint64_t kHead = 64;  // bytes at the start that come alone: what opens a file has no neighbours that are read next
  static constexpr uint64_t kBlock = BlockFolder::kBlock;
  static constexpr size_t kMemory = size_t{64} << 20;
  static constexpr uint64_t kLongest = (1 << 20) / kBlock;  // blocks that are fetched by one request
  static constexpr size_t kTogether = 24;                   // requests that are under way for one caller, or wait for those that are
  static constexpr uint64_t kGap = (1 << 17) / kBlock;      // blocks that are fetched though nobody wants them, to save a request

 private:
  using Block = std::shared_ptr<const Bytes>;
  size_t size_of(uint64_t block) const;
  bool is_kept(uint64_t offset, uint64_t size) const;
  // REQUIRES: they ascend.
  std::vector<Block> blocks(const std::vector<uint64_t>& wanted) const;
  std::vector<Block> fetch(const std::vector<uint64_t>& missing) const;
  uint64_t ahead_of(uint64_t first, uint64_t last) const;

  const std::array<uint8_t, kHead>& head() const;

  const std::unique_ptr<ByteSource> far_;
  const std::unique_ptr<BlockFolder> disk_;
  const Kept kept_;
  const std::shared_ptr<BlockCache> cache_;
  const uint64_t number_;  // in the cache
  const size_t memory_;    // what one caller fills at a time, and a quarter of which is kept of one read
  mutable Once head_read_;
  mutable std::array<uint8_t, kHead> head_{};
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  mutable std::set<uint64_t> fetched_now_;  // blocks that some thread fetches
  mutable uint64_t next_ = 0, window_ = 0;  // the block after the last one that a read fetched; how far reads in a row look ahead
};

}  // namespace teracell::store
