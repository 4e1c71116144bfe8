// What a channel of cells has for chunks of level 0, decoded, and kept in a cache.
#pragma once
#include <functional>

#include <fmt/format.h>

#include "store/base/lru_cache.hpp"
#include "store/read/reader.hpp"

namespace teracell::inline store {

template <class T>
using CellChunkCache = LruCache<ChunkPlace, T, ChunkPlaceHash>;

// Threads may share it. Throws IoError or FormatError, like its reader.
template <class T>
class CellChunks {
 public:
  static constexpr size_t kMemory = size_t{32} << 20;
  // Makes what a chunk has from its frame, or from null where it has none.
  using Make = std::function<void(const ChunkKey&, const Bytes* frame, T& out)>;

  // Keeps a reference to the reader. Without a cache, it has its own. Throws UsageError if the grid has no such `channel`: it is null.
  CellChunks(const GridReader& reader, const Channel* channel, const char* name, std::shared_ptr<CellChunkCache<T>> cache, Make make)
      : reader_(reader), channel_(channel), make_(std::move(make)), cache_(cache ? std::move(cache) : std::make_shared<CellChunkCache<T>>(kMemory)) {
    if (channel_ == nullptr && std::ranges::find(reader.meta().others(), name, &Channel::name) != reader.meta().others().end())
      throw UsageError(fmt::format("{}: its {} are in a coding that this version can't read", reader.name(), name));
    if (channel_ == nullptr) throw UsageError(fmt::format("{}: the grid has no {}: it was meshed without them", reader.name(), name));
    number_ = cache_->new_owner();
  }

  std::shared_ptr<const T> get(const ChunkKey& key) const {
    if (auto kept = cache_->find({number_, key})) return kept;
    auto made = std::make_shared<T>();
    thread_local Bytes frame;
    try {
      make_(key, reader_.read_cells(*channel_, key, frame) ? &frame : nullptr, *made);
    } catch (const FormatError& e) {
      const std::string message = e.what();
      throw FormatError(message.starts_with(reader_.name()) ? message : fmt::format("{}: {}: {}", reader_.name(), chunk_name(key), message));
    }
    cache_->add({number_, key}, made, made->memory());
    return made;
  }
  void prefetch(const Box& box) const { reader_.prefetch_cells(*channel_, box); }

 private:
  const GridReader& reader_;
  const Channel* const channel_;
  const Make make_;
  const std::shared_ptr<CellChunkCache<T>> cache_;
  uint64_t number_ = 0;
};

}  // namespace teracell::store
