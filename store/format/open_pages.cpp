#include "store/format/open_pages.hpp"

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::inline store {

std::optional<OpenPages::Page> OpenPages::put(const ChunkKey& key, ChunkEntry entry) {
  const uint64_t page = shape_.page_of(key);
  const auto [it, fresh] = open_.try_emplace(page);
  Open& open = it->second;
  if (fresh) {
    open.missing = shape_.page_size(page);
    open.entries.resize(open.missing);
  }
  open.entries[shape_.slot_of(key, page)] = std::move(entry);
  if (--open.missing > 0) return std::nullopt;
  for (const ChunkEntry& e : open.entries)
    if (e.size == 0 && e.uniform.empty())
      throw FormatError(
          fmt::format("level {} index page {}: a chunk is there twice, and another one is missing (FORMAT.md 16.2)", shape_.level, page));
  Page complete{page, std::move(open.entries)};
  open_.erase(it);
  return complete;
}

void OpenPages::save(Bytes& state) const {
  put_varint(state, open_.size());
  for (const auto& [page, open] : open_) {
    put_varint(state, page);
    put_varint(state, open.missing);
    std::vector<ChunkEntry> entries = open.entries;
    for (ChunkEntry& e : entries)
      if (e.size == 0 && e.uniform.empty()) e.uniform = {0};  // still missing, but a page is valid entries only
    put_sized(state, encode_page(entries, with_stats()));
  }
}

void OpenPages::restore(ByteReader& state) {
  for (uint64_t left = state.varint(0, shape_.pages(), "open pages"); left > 0; --left) {
    const uint64_t page = state.varint(0, shape_.pages() - 1, "page");
    Open& open = open_[page];
    const size_t chunks = shape_.page_size(page);
    open.missing = state.varint(1, chunks, "missing chunks");
    open.entries = decode_page(state.take_sized(), chunks, with_stats(), labels_);
  }
}

}  // namespace teracell::store
