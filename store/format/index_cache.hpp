// A cache for the parts of the index, blocks of directories and pages: each leads to many chunks. Readers that share a cache
// share its memory. Threads may share it.
#pragma once
#include "store/base/lru_cache.hpp"
#include "store/format/format.hpp"

namespace teracell::inline store {

struct IndexPlace {
  uint64_t reader;  // IndexCache::new_owner()
  bool page;        // or else a block, or a frame of a channel
  uint64_t at;      // a page's number * 32 + level; a block's or frame's offset in the file
  friend bool operator==(const IndexPlace&, const IndexPlace&) = default;
};
struct IndexPlaceHash {
  size_t operator()(const IndexPlace& p) const { return ((p.reader * 2 + p.page) * 0x9E3779B97F4A7C15 ^ p.at) * 0x9E3779B97F4A7C15 >> 16; }
};
struct IndexPart {  // a block, a page, or a page or list of a channel of cells (cell_frames.hpp)
  std::vector<DirectoryEntry> block;
  std::vector<ChunkEntry> page;
  std::vector<uint64_t> cells;
};

using IndexCache = LruCache<IndexPlace, IndexPart, IndexPlaceHash>;

}  // namespace teracell::store
