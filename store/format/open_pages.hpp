// The index pages of a level that are not complete, while the chunks of a file come in the order of the tree.
#pragma once
#include <map>
#include <optional>

#include "store/format/format.hpp"
#include "store/grid/metadata.hpp"

namespace teracell::inline store {

class OpenPages {
 public:
  struct Page {
    uint64_t number;
    std::vector<ChunkEntry> entries;
  };
  OpenPages(const Metadata& meta, int level) : shape_(meta, level), labels_(static_cast<uint32_t>(meta.labels.size())) {}
  const LevelShape& shape() const { return shape_; }
  bool empty() const { return open_.empty(); }
  // Takes the entry of a chunk. Returns its page if this was the last chunk of it. Throws FormatError when it then turns out that a chunk
  // was put twice in place of another one.
  std::optional<Page> put(const ChunkKey& key, ChunkEntry entry);
  void save(Bytes& state) const;
  void restore(ByteReader& state);

 private:
  struct Open {
    std::vector<ChunkEntry> entries;
    size_t missing;
  };
  bool with_stats() const { return shape_.level == 0; }
  LevelShape shape_;
  uint32_t labels_;
  std::map<uint64_t, Open> open_;
};

}  // namespace teracell::store
